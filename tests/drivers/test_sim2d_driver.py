import math
import os
from pathlib import Path

import numpy as np
import pytest
from explore_bt_drivers import Sim2d, Sim2dOptions, explore_bt_register
from explore_bt_drivers.world import load_world
from hypothesis import example, given, settings
from hypothesis import strategies as st
from pydantic import ValidationError

from explore_bt.errors import WorldError
from explore_bt.interfaces import RobotContext
from explore_bt.maps import write_map
from explore_bt.testing.driver_contract import DriverContract
from explore_bt.types import (
    FREE,
    Battery,
    Imu,
    Measurement,
    OccupancyGrid,
    Pose2,
    Scan2D,
    Twist2,
    WheelOdometry,
)

from .conftest import drive, prints

WORLDS = Path(__file__).parents[2] / "missions" / "worlds"
ROOM = WORLDS / "room.yaml"


def ready(world: Path = ROOM, context: RobotContext | None = None, **options: object) -> Sim2d:
    driver = Sim2d(Sim2dOptions.model_validate({"world": world, **options}))
    driver.setup(context or RobotContext(seed=3))
    return driver


class TestSim2d(DriverContract):
    """In a world drawn in YAML."""

    def make(self, tmp_path: Path) -> Sim2d:
        return Sim2d(Sim2dOptions.model_validate({"world": ROOM}))


class TestSim2dOnAMap(DriverContract):
    """On a map_server map, without noise."""

    context = RobotContext(seed=1, start=Pose2(0.0, 0.0, 1.0))

    def make(self, tmp_path: Path) -> Sim2d:
        grid = OccupancyGrid(np.full((80, 80), FREE, dtype=np.int8), 0.05, (-2.0, -2.0))
        world = write_map(grid, tmp_path)[1]
        return Sim2d(Sim2dOptions.model_validate({"world": world, "noise": False, "beams": 90}))


class TestSim2dAmongPeople(DriverContract):
    """With walkers, a person on a route, a door that shuts and furniture that is moved."""

    def make(self, tmp_path: Path) -> Sim2d:
        return Sim2d(Sim2dOptions.model_validate({"world": WORLDS / "busy_flat.yaml", "walkers": 3}))


def test_the_package_registers_its_drivers() -> None:
    assert Sim2d in explore_bt_register()


def test_rates_and_stamps_are_as_asked_for() -> None:
    measured = drive(ready(lidar_rate=8, imu_rate="50 Hz", odometry_rate=30), Twist2(), 2.0)
    for kind, rate in [(Scan2D, 8), (Imu, 50), (WheelOdometry, 30)]:
        stamps = [m.stamp_s for m in measured if isinstance(m, kind)]
        assert stamps == pytest.approx([(i + 1) / rate for i in range(2 * rate)])


@settings(deadline=None, max_examples=15)
@example(cuts=[0.078125])
@given(cuts=st.lists(st.floats(0.0, 3.0), max_size=12))
def test_how_the_waiting_is_cut_up_changes_nothing(cuts: list[float]) -> None:
    odd: dict[str, object] = {"imu_rate": 87.3, "lidar_rate": 7.7, "odometry_rate": 33.333333}
    whole, parts = ready(**odd), ready(**odd)
    for driver in (whole, parts):
        driver.command(Twist2(0.3, 0.5))
    whole.clock.wait_until(3.0)
    measured: list[Measurement] = []
    for cut in sorted(cuts):
        parts.clock.wait_until(cut)
        measured += parts.read()
    parts.clock.wait_until(3.0)
    measured += parts.read()
    assert prints(measured) == prints(whole.read())
    assert parts.truth().pose() == whole.truth().pose()


def test_seeds_repeat_and_differ() -> None:
    runs = [drive(ready(context=RobotContext(seed=s)), Twist2(0.2, 0.1), 1.0) for s in (1, 1, 2)]
    assert prints(runs[0]) == prints(runs[1])
    assert prints(runs[0]) != prints(runs[2])


def test_a_scan_at_rest_without_noise_is_the_world_itself() -> None:
    driver = ready(noise=False)
    scan = next(m for m in drive(driver, Twist2(), 0.2) if isinstance(m, Scan2D))
    pose = driver.start
    expected = load_world(ROOM).cast(pose.x, pose.y, scan.angles_rad + pose.yaw_rad, 5.0)
    assert np.array_equal(scan.ranges_m, expected.astype(np.float32))
    assert scan.angles_rad[0] == -math.pi
    assert (scan.times_s[0], scan.times_s[-1]) == (pytest.approx(-0.1 * 359 / 360), 0.0)


def test_every_beam_is_cast_from_the_pose_at_its_own_time(tmp_path: Path) -> None:
    path = tmp_path / "hall.yaml"
    path.write_text("format: explore-bt-world/1\nbounds: [0, 0, 8, 8]\nstart: [4, 4, 0]\n")
    driver = ready(path, noise=False, lidar_range=10, turn_rate=1.0, turn_acceleration=50, turn_jerk=1000)
    scan = [m for m in drive(driver, Twist2(0.0, 1.0), 1.5) if isinstance(m, Scan2D)][-1]
    yaw = driver.truth().pose().yaw_rad  # the last beam's, at 1.5 s
    world_angles = yaw + 1.0 * scan.times_s + scan.angles_rad
    expected = 4.0 / np.maximum(np.abs(np.cos(world_angles)), np.abs(np.sin(world_angles)))
    assert scan.ranges_m == pytest.approx(expected, abs=1e-5)


def test_beyond_its_range_the_lidar_says_infinity_and_never_more(tmp_path: Path) -> None:
    path = tmp_path / "field.yaml"
    path.write_text("format: explore-bt-world/1\nbounds: [0, 0, 10, 10]\nstart: [5, 5, 0]\n")
    scans = [m for m in drive(ready(path), Twist2(), 2.0) if isinstance(m, Scan2D)]
    ranges = np.concatenate([s.ranges_m for s in scans])
    assert np.isinf(ranges).mean() > 0.9
    assert ranges[np.isfinite(ranges)].max() <= 5.0


def test_noise_and_drop_outs_have_the_size_asked_for() -> None:
    exact = next(m for m in drive(ready(noise=False), Twist2(), 0.2) if isinstance(m, Scan2D))
    noisy = ready(range_noise="2 cm", dropout=0.1)
    ranges = np.array([m.ranges_m for m in drive(noisy, Twist2(), 10.0) if isinstance(m, Scan2D)])
    inside = exact.ranges_m < 4.8
    error = ranges[:, inside] - exact.ranges_m[inside]
    assert np.nanstd(error) == pytest.approx(0.02, rel=0.05)
    assert abs(np.nanmean(error)) < 0.001
    assert np.isnan(ranges).mean() == pytest.approx(0.1, abs=0.01)


def test_the_gyro_has_a_constant_bias_and_white_noise() -> None:
    options = {"gyro_bias": "2 deg/s", "gyro_noise": "0.01 rad/s"}
    biases = []
    for seed in range(6):
        driver = ready(context=RobotContext(seed=seed), **options)
        driver.clock.wait_until(10.0)
        rates = [m.angular_velocity_rps[2] for m in driver.read() if isinstance(m, Imu)]
        assert np.std(rates) == pytest.approx(0.01, rel=0.1)
        biases.append(np.mean(rates))
    assert 0.2 * math.radians(2) < np.std(biases) < 3 * math.radians(2)


def test_the_accelerometer_feels_speeding_up_cornering_and_gravity(tmp_path: Path) -> None:
    path = tmp_path / "field.yaml"
    path.write_text("format: explore-bt-world/1\nbounds: [0, 0, 20, 20]\n")
    driver = ready(path, noise=False)
    samples = [m for m in drive(driver, Twist2(0.5, 0.6), 4.0) if isinstance(m, Imu)]
    assert max(s.linear_acceleration_mps2[0] for s in samples) == pytest.approx(0.5)
    assert samples[-1].linear_acceleration_mps2 == pytest.approx((0.0, 0.3, 9.81))
    assert samples[-1].angular_velocity_rps == pytest.approx((0.0, 0.0, 0.6))


def test_wheels_are_exact_without_noise_and_drift_with_it(tmp_path: Path) -> None:
    path = tmp_path / "field.yaml"
    path.write_text("format: explore-bt-world/1\nbounds: [0, 0, 30, 30]\n")
    errors = {}
    for noise in (False, True):
        driver = ready(path, noise=noise)
        last = [m for m in drive(driver, Twist2(0.5, 0.1), 40.0) if isinstance(m, WheelOdometry)][-1]
        moved = driver.start.between(driver.truth().pose())
        errors[noise] = moved.distance_to(last.T_odom_base)
    assert errors[False] < 1e-6
    assert 0.05 < errors[True] < 8.0


def test_truth_knows_contacts_and_clearance() -> None:
    driver = ready(context=RobotContext(start=Pose2(1.0, 1.0, math.pi)))
    assert driver.truth().clearance_m() == pytest.approx(0.95)
    drive(driver, Twist2(0.5, 0.0), 4.0)
    assert driver.truth().contacts() == 1
    assert driver.truth().clearance_m() == pytest.approx(0.25, abs=2e-6)


def test_the_observable_floor_is_computed_once_and_holds_the_whole_room() -> None:
    truth = ready().truth()
    floor = truth.observable_floor()
    assert truth.observable_floor() is floor
    free_m2 = (3.9 * 4.9 - 1.4 * 2.05 - 0.13) + (1.9 * 2.1 - 0.45) + 0.9 * 0.1  # room, chamber, doorway
    assert floor.free.sum() * 0.05**2 == pytest.approx(free_m2, rel=0.01)


def test_without_a_start_the_robot_stands_where_the_file_says_or_where_it_is_widest(tmp_path: Path) -> None:
    assert ready().start.xy == (1.0, 1.0)
    path = tmp_path / "hall.yaml"
    path.write_text("format: explore-bt-world/1\nrooms: [{name: a, box: [0, 0, 4, 4]}]\n")
    start = ready(path).start
    assert start.xy == pytest.approx((2.0, 2.0), abs=0.03)
    assert start == ready(path).start


def test_it_is_refused_before_setup() -> None:
    driver = Sim2d(Sim2dOptions.model_validate({"world": ROOM}))
    with pytest.raises(RuntimeError, match="before setup"):
        driver.read()


def test_after_close_commands_are_not_heard() -> None:
    driver = ready()
    driver.close()
    drive(driver, Twist2(0.5, 0.0), 1.0)
    assert driver.truth().pose() == driver.start


@pytest.mark.parametrize(
    ("start", "message"),
    [
        (
            Pose2(0.2, 1.0, 0.0),
            "the start (0.20, 1.00) is 0.15 m from wall of room; the robot's radius of 0.25 m needs 0.25 m "
            "clearance. The nearest start that fits is [0.325 m, 0.975 m, 0 deg]",
        ),
        (Pose2(1.0, 3.5, 1.57), "the start (1.00, 3.50) lies inside bed; the robot's radius"),
        (Pose2(0.0, 1.0, 0.0), "the start (0.00, 1.00) lies inside wall of room"),
        (Pose2(50.0, 1.0, 0.0), "the start (50.00, 1.00) lies inside the edge of the world"),
        (Pose2(math.nan, 1.0, 0.0), "is not a place; give finite numbers"),
    ],
)
def test_a_start_that_does_not_fit_is_refused_with_the_nearest_that_does(start: Pose2, message: str) -> None:
    with pytest.raises(WorldError) as caught:
        ready(context=RobotContext(start=start))
    text = str(caught.value).replace(f"{ROOM.parent}{os.sep}", "")
    assert text.startswith("room.yaml: the start")
    assert message in text
    assert "\n" not in text


def test_the_proposed_start_is_accepted() -> None:
    assert ready(context=RobotContext(start=Pose2(0.325, 0.975, 0.0))).start.x == 0.325


def test_a_robot_too_wide_for_the_world_is_told_so() -> None:
    with pytest.raises(WorldError, match="No place in this world is wide enough for a radius of 2 m"):
        ready(radius=2.0)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"world": "nowhere.yaml"}, "nowhere.yaml: there is no such file"),
        ({"world": str(WORLDS)}, r"cannot be read \(is a directory\); give the path of"),
    ],
)
def test_a_world_that_is_not_there_is_refused_at_setup(options: dict[str, object], message: str) -> None:
    with pytest.raises(WorldError, match=message):
        Sim2d(Sim2dOptions.model_validate(options)).setup(RobotContext())


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({}, "world"),
        ({"world": ROOM, "radius": "30 s"}, "30 s is not a length; write 0.30 m or 30 cm"),
        ({"world": ROOM, "radius": "1 mm"}, "greater than or equal to 0.05"),
        ({"world": ROOM, "beams": 0}, "greater than or equal to 1"),
        ({"world": ROOM, "beams": 3000}, "less than or equal to 2000"),
        ({"world": ROOM, "lidar_rate": "fast"}, "fast is not a frequency; write 10 Hz"),
        ({"world": ROOM, "dropout": 2}, "less than or equal to 1"),
        ({"world": ROOM, "raidus": 0.2}, "raidus"),
        ({"world": 7}, "7 is not a file name"),
    ],
)
def test_options_of_the_wrong_type_or_unit_are_refused(options: dict[str, object], message: str) -> None:
    with pytest.raises(ValidationError, match=message):
        Sim2dOptions.model_validate(options)


def test_the_battery_drains_evenly_and_only_where_one_is_asked_for() -> None:
    told = [m for m in drive(ready(battery_life="4 s"), Twist2(), 5.0) if isinstance(m, Battery)]
    assert [m.stamp_s for m in told] == [1.0, 2.0, 3.0, 4.0, 5.0]
    assert [m.charge for m in told] == pytest.approx([0.75, 0.5, 0.25, 0.0, 0.0])
    assert not [m for m in drive(ready(), Twist2(), 2.0) if isinstance(m, Battery)]
