"""The driver as the framework meets it; physics and sensors have files of their own."""

from pathlib import Path

import numpy as np
import pytest
from explore_bt_drivers.mujoco import Mujoco, MujocoOptions
from pydantic import ValidationError

from explore_bt.errors import WorldError
from explore_bt.interfaces import Resumption, RobotContext
from explore_bt.testing.driver_contract import DriverContract
from explore_bt.types import (
    Battery,
    BodyFaultKind,
    Imu,
    Measurement,
    PointCloud,
    Pose2,
    Twist2,
    WheelOdometry,
)

WORLDS = Path(__file__).parents[2] / "missions" / "worlds"
ROOM = WORLDS / "room.yaml"


def ready(world: Path = ROOM, context: RobotContext | None = None, **options: object) -> Mujoco:
    driver = Mujoco(MujocoOptions.model_validate({"world": world, **options}))
    driver.setup(context or RobotContext(seed=3))
    return driver


def drive(driver: Mujoco, twist: Twist2, duration_s: float) -> list[Measurement]:
    measured: list[Measurement] = []
    for _ in range(round(duration_s / 0.05)):
        driver.command(twist)
        driver.clock.wait_until(driver.clock.now_s() + 0.05)
        measured += driver.read()
    return measured


class TestMujoco(DriverContract):
    """In a world drawn in YAML."""

    def make(self, tmp_path: Path) -> Mujoco:
        return Mujoco(MujocoOptions.model_validate({"world": ROOM, "columns": 180}))


def test_a_run_among_people_repeats_bit_for_bit() -> None:
    """Walkers, a person on a route, a door that shuts and furniture that is moved."""
    world, context = WORLDS / "busy_flat.yaml", RobotContext(seed=5)
    runs = []
    for _ in range(2):
        driver = ready(world, context, columns=90, walkers=2)
        measured = drive(driver, Twist2(0.15, 0.2), 1.5)
        assert len(driver.truth().people()) > 2
        runs.append(
            [each.points.tobytes() if isinstance(each, PointCloud) else repr(each) for each in measured]
        )
    assert runs[0] == runs[1]


def test_a_mission_for_sim2d_needs_one_word_changed() -> None:
    given = {"world": ROOM, "radius": "0.25 m", "lidar_range": "5 m", "noise": False, "walkers": 1}
    driver = ready(**{key: value for key, value in given.items() if key != "world"})
    assert driver.footprint_radius_m == 0.27
    assert ready(radius="0.4 m").footprint_radius_m == 0.4


@pytest.mark.parametrize(("option", "words"), [("beams", "say columns"), ("slip_rate", "leave it out")])
def test_options_that_mean_nothing_here_are_refused_by_name(option: str, words: str) -> None:
    with pytest.raises(ValidationError, match=f"{option} is of sim2d; .*{words}"):
        MujocoOptions.model_validate({"world": ROOM, option: 1})


def test_a_start_without_room_is_refused_with_a_place_that_has_it() -> None:
    with pytest.raises(WorldError, match=r"The nearest start that fits is \["):
        ready(context=RobotContext(start=Pose2(0.2, 0.2, 0.0)))


def test_sensors_come_at_their_rates_with_their_stamps() -> None:
    driver = ready(battery_life="100 s", columns=90)
    measured = drive(driver, Twist2(), 2.0)
    count = {
        kind: sum(isinstance(each, kind) for each in measured)
        for kind in (PointCloud, Imu, WheelOdometry, Battery)
    }
    assert count == {PointCloud: 20, Imu: 500, WheelOdometry: 40, Battery: 2}
    stamps = [each.stamp_s for each in measured if isinstance(each, Imu)]
    np.testing.assert_allclose(np.diff(stamps), 0.004)


def test_the_imu_feels_noise_and_a_constant_bias() -> None:
    driver = ready(columns=90, gyro_noise=0.003, gyro_bias=0.05, accel_noise=0.05, accel_bias=0.0)
    felt = np.array(
        [
            (*s.angular_velocity_rps, *s.linear_acceleration_mps2)
            for s in drive(driver, Twist2(), 4.0)
            if isinstance(s, Imu)
        ]
    )[250:]
    assert felt[:, :3].std(axis=0) == pytest.approx(0.003, rel=0.15)
    assert felt[:, 4].std() == pytest.approx(0.05, rel=0.15)
    assert np.abs(felt[:, :3].mean(axis=0)).max() > 0.01
    exact = ready(columns=90, noise=False)
    samples = [each for each in drive(exact, Twist2(), 4.0) if isinstance(each, Imu)][500:]
    still = np.array([each.angular_velocity_rps for each in samples])
    assert np.abs(still).max() < 1e-3


def test_wheels_without_noise_reckon_within_two_percent() -> None:
    driver = ready(columns=90, noise=False)
    begin = driver.truth().pose()
    measured = drive(driver, Twist2(0.2, 0.5), 6.0)
    reckoned = [each.T_odom_base for each in measured if isinstance(each, WheelOdometry)][-1]
    driven = begin.between(driver.truth().pose())
    assert reckoned.distance_to(driven) < 0.03
    assert reckoned.yaw_rad == pytest.approx(driven.yaw_rad, abs=0.06)


def test_driving_into_a_wall_is_a_contact_and_the_robot_bears_it() -> None:
    driver = ready(columns=90, context=RobotContext(start=Pose2(1.0, 1.0, 3.1416)))
    drive(driver, Twist2(0.3, 0.0), 6.0)
    assert driver.truth().contacts() >= 1
    assert driver.truth().clearance_m() < 0.3
    assert driver.fault is None


def test_standing_in_free_space_touches_nothing() -> None:
    driver = ready(columns=90)
    drive(driver, Twist2(0.15, 0.3), 3.0)
    assert driver.truth().contacts() == 0
    assert driver.truth().clearance_m() > driver.footprint_radius_m


def test_a_table_top_counts_as_a_contact_where_the_mast_meets_it(tmp_path: Path) -> None:
    world = tmp_path / "table.yaml"
    world.write_text(
        "format: explore-bt-world/1\nrooms: [{name: hall, box: [0, 0, 6, 4]}]\n"
        "furniture: [{name: table, box: [3, 0.6, 4, 3.4], legs: 5 cm, height: 0.45}]\n"
    )
    driver = ready(world, RobotContext(start=Pose2(1.5, 2.0, 0.0)), columns=90)
    drive(driver, Twist2(0.3, 0.0), 7.0)
    assert driver.truth().contacts() >= 1
    assert driver.truth().pose().x == pytest.approx(2.95, abs=0.15)


RIDGE = (
    "format: explore-bt-world/1\nrooms: [{name: a, box: [0, 0, 4, 3]}, {name: b, box: [4, 0, 9, 3]}]\n"
    "doors: [{name: door, at: [4, 1.5], width: 1 m, sill: 2 cm}]\n"
    "ramps: [{name: ramp, box: [5, 0.5, 8, 2.5], slope: 3 deg, level: 20 cm}]\n"
)


def test_sills_and_ramps_are_driven_over_and_are_no_contacts(tmp_path: Path) -> None:
    world = tmp_path / "steps.yaml"
    world.write_text(RIDGE)
    driver = ready(world, RobotContext(start=Pose2(3.0, 1.5, 0.0)), columns=90)
    drive(driver, Twist2(0.4, 0.0), 13.0)
    assert driver.fault is None
    assert driver.truth().pose().x > 7.5
    assert driver.truth().contacts() == 0


@pytest.mark.parametrize(
    "start",
    [
        pytest.param(Pose2(4.0, 1.5, 0.0), id="on the sill"),
        pytest.param(Pose2(4.05, 1.5, 1.4), id="one wheel on the sill"),
        pytest.param(Pose2(5.6, 1.5, 0.0), id="up the ramp"),
        pytest.param(Pose2(5.6, 1.5, 1.57), id="along the slope"),
        pytest.param(Pose2(7.9, 1.5, 2.5), id="at its foot"),
    ],
)
def test_a_robot_begins_with_its_wheels_on_what_is_under_them(start: Pose2, tmp_path: Path) -> None:
    world = tmp_path / "ridge.yaml"
    world.write_text(RIDGE)
    driver = ready(world, RobotContext(start=start), columns=90)
    wheels = driver._running().data.contact
    assert len(wheels) >= 2
    assert float(wheels.dist.min()) > -1e-3
    drive(driver, Twist2(), 3.0)
    assert driver.fault is None
    assert driver.truth().contacts() == 0
    assert driver.truth().pose().distance_to(start) < 0.15


def test_who_walks_into_a_standing_robot_is_not_its_contact(tmp_path: Path) -> None:
    world = tmp_path / "person.yaml"
    world.write_text(
        "format: explore-bt-world/1\nrooms: [{name: hall, box: [0, 0, 8, 4]}]\n"
        "people: [{name: ada, route: [[1, 2], [7, 2]], speed: 0.5 m/s, radius: 0.2 m}]\n"
    )
    driver = ready(world, RobotContext(start=Pose2(4.0, 2.0, 1.57)), columns=90)
    drive(driver, Twist2(), 8.0)
    assert driver.truth().contacts() == 0
    assert driver.truth().touched_by_people() >= 1


def test_a_fallen_robot_says_so_and_is_stood_up_on_request() -> None:
    driver = ready(columns=90)
    base = driver._running().data.body("base_link")
    base.xfrc_applied[0] = 900.0
    drive(driver, Twist2(), 0.1)
    base.xfrc_applied[0] = 0.0
    drive(driver, Twist2(), 2.0)
    assert driver.fault is not None
    assert driver.fault.kind is BodyFaultKind.FALLEN
    assert driver.recover()
    assert driver.fault.kind is BodyFaultKind.RECOVERING
    drive(driver, Twist2(), 4.0)
    assert driver.fault is None
    assert driver.truth().clearance_m() > 0.27


def test_a_resumed_run_goes_on_where_and_when_it_broke_off() -> None:
    stand = Pose2(1.5, 1.5, 0.4)
    driver = ready(context=RobotContext(resumed=Resumption(12.5, Pose2(1.6, 1.5, 0.4), stand)), columns=90)
    assert driver.clock.now_s() == 12.5
    assert driver.truth().pose().distance_to(stand) < 1e-6
    measured = drive(driver, Twist2(), 0.5)
    assert min(each.stamp_s for each in measured) > 12.5


def test_measurements_do_not_depend_on_how_the_waiting_is_cut_up() -> None:
    one, other = ready(columns=90, walkers=0), ready(columns=90, walkers=0)
    for driver, cuts in ((one, 1), (other, 7)):
        driver.command(Twist2(0.15, 0.2))
        for cut in range(1, cuts + 1):
            driver.clock.wait_until(0.4 * cut / cuts)
    first, second = one.read(), other.read()
    assert [type(each) for each in first] == [type(each) for each in second]
    for a, b in zip(first, second, strict=True):
        if isinstance(a, PointCloud):
            np.testing.assert_array_equal(a.points, b.points)
        else:
            assert a == b


def test_a_film_shows_the_robot_where_it_is_and_changes_nothing() -> None:
    plain, filmed = ready(columns=90), ready(columns=90)
    film = filmed.filming((320, 180))
    pictures, measured = [film.frame()], []
    for _ in range(20):
        measured += drive(filmed, Twist2(0.3, 0.3), 0.1)
        pictures.append(film.frame())
    film.close()
    expected = [each for _ in range(20) for each in drive(plain, Twist2(0.3, 0.3), 0.1)]
    assert [repr(each) for each in measured if isinstance(each, Imu)] == [
        repr(each) for each in expected if isinstance(each, Imu)
    ]
    assert {picture.shape for picture in pictures} == {(180, 320, 3)}
    # the robot is grey and in the middle, and the brown floor goes by beneath it
    for picture in pictures:
        middle = picture[75:105, 145:175].astype(int)
        assert ((middle.min(axis=-1) > 140) & (np.ptp(middle, axis=-1) < 16)).sum() > 40
    assert (pictures[0][:100] != pictures[-1][:100]).mean() > 0.5
