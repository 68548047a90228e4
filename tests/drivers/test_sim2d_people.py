import math
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from explore_bt_drivers import Sim2d, Sim2dOptions
from explore_bt_drivers.world import load_world
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from explore_bt.errors import WorldError
from explore_bt.interfaces import RobotContext
from explore_bt.maps import write_map
from explore_bt.types import FREE, OCCUPIED, Measurement, OccupancyGrid, Pose2, Scan2D, Twist2

from .conftest import drive, prints

WORLDS = Path(__file__).parents[2] / "missions" / "worlds"
ROOM, APARTMENT = WORLDS / "room.yaml", WORLDS / "apartment.yaml"
FIELD = "format: explore-bt-world/1\nbounds: [-10, -10, 10, 10]\n"


def ready(world: Path, start: Pose2 | None = None, seed: int = 3, **options: object) -> Sim2d:
    driver = Sim2d(Sim2dOptions.model_validate({"world": world, **options}))
    driver.setup(RobotContext(seed=seed, start=start))
    return driver


def field(folder: Path, people: str = "[]") -> Path:
    path = folder / "field.yaml"
    path.write_text(f"{FIELD}start: [0, 0, 0]\npeople: {people}\n")
    return path


def scans(measured: list[Measurement]) -> list[Scan2D]:
    return [m for m in measured if isinstance(m, Scan2D)]


def ranges_to_disc(
    origin: NDArray[np.float64], angles: NDArray[np.float64], centre: NDArray[np.float64], radius: float
) -> NDArray[np.float64]:
    """(N,) first distance at which points along rays, 0.1 mm apart, lie in a disc; inf from inside it."""
    steps = np.arange(0.0, 6.0, 1e-4)
    result = np.full(len(angles), math.inf)
    for i, angle in enumerate(angles):
        if math.dist(origin[i], centre[i]) <= radius:
            continue
        points = origin[i] + steps[:, None] * [math.cos(angle), math.sin(angle)]
        inside = np.hypot(*(points - centre[i]).T) <= radius
        if inside.any():
            result[i] = steps[int(np.argmax(inside))]
    return result


def test_the_lidar_sees_people_where_they_are_at_each_beams_own_time(tmp_path: Path) -> None:
    ada = "{name: ada, route: [[2, -6], [2, 6]], speed: 2, radius: 0.3}"
    bob = "{name: bob, route: [[-6, 1], [6, 1]], speed: 1.5, radius: 0.2}"
    driver = ready(
        field(tmp_path, f"[{ada}, {bob}]"), noise=False, lidar_range=5, lidar_rate="2 Hz", beams=120
    )
    for scan in scans(drive(driver, Twist2(0.0, 0.0), 6.0)):
        times = scan.stamp_s + scan.times_s
        origin = np.zeros((120, 2))
        on_ada = np.column_stack((np.full(120, 2.0), 2 * times - 6))
        on_bob = np.column_stack((1.5 * times - 6, np.full(120, 1.0)))
        expected = np.minimum(
            ranges_to_disc(origin, scan.angles_rad, on_ada, 0.3),
            ranges_to_disc(origin, scan.angles_rad, on_bob, 0.2),
        )
        expected[expected > 5.0] = math.inf
        seen = np.isfinite(expected)
        assert np.array_equal(np.isfinite(scan.ranges_m), seen)
        assert scan.ranges_m[seen] == pytest.approx(expected[seen], abs=2e-4)


def test_walls_hide_people_and_people_hide_walls(tmp_path: Path) -> None:
    path = field(
        tmp_path, "[{name: ada, route: [[2, 0], [2, 0.001]]}, {name: bob, route: [[-3, 0], [-3, 1]]}]"
    )
    path.write_text(path.read_text() + "walls: [{path: [[-1, -1], [-1, 1]]}, {path: [[3, -1], [3, 1]]}]\n")
    scan = scans(drive(ready(path, noise=False, beams=360), Twist2(), 0.1))[0]
    assert scan.ranges_m[180] == pytest.approx(1.75, abs=1e-5)
    assert scan.ranges_m[0] == pytest.approx(0.95)
    assert scan.ranges_m[190] == pytest.approx(2.95 / math.cos(math.radians(10)), abs=1e-5)


def test_a_person_who_walks_through_the_lidar_is_not_seen_from_inside(tmp_path: Path) -> None:
    driver = ready(field(tmp_path, "[{name: ada, route: [[-2, 0], [2, 0]], speed: 1}]"), beams=36)
    for scan in scans(drive(driver, Twist2(), 4.0)):
        away = np.abs(scan.stamp_s + scan.times_s - 2.0)
        assert not np.isfinite(scan.ranges_m[away < 0.25]).any()
        finite = scan.ranges_m[np.isfinite(scan.ranges_m)]
        assert (finite >= 0.02).all()


def test_people_out_of_sight_change_no_measurement(tmp_path: Path) -> None:
    lonely = ready(field(tmp_path))
    expected = prints(drive(lonely, Twist2(0.2, 0.4), 5.0))
    crowded = ready(field(tmp_path, "[{name: ada, route: [[-9, -9], [-9, 9]]}]"))
    assert prints(drive(crowded, Twist2(0.2, 0.4), 5.0)) == expected
    assert len(crowded.truth().people()) == 1


@settings(deadline=None, max_examples=10)
@given(cuts=st.lists(st.floats(0.0, 20.0), max_size=12))
def test_walkers_do_the_same_however_the_waiting_is_cut_up(cuts: list[float]) -> None:
    odd: dict[str, object] = {"walkers": 3, "walker_speed": 1.7, "lidar_rate": 0.7, "beams": 90}
    whole, parts = ready(APARTMENT, **odd), ready(APARTMENT, **odd)
    for driver in (whole, parts):
        driver.command(Twist2(0.3, 0.5))
    whole.clock.wait_until(20.0)
    measured: list[Measurement] = []
    for cut in sorted(cuts):
        parts.clock.wait_until(cut)
        measured += parts.read()
    parts.clock.wait_until(20.0)
    measured += list(parts.read())
    assert prints(measured) == prints(list(whole.read()))
    assert np.array_equal(parts.truth().people(), whole.truth().people())
    assert parts.truth().contacts() == whole.truth().contacts()


def test_walkers_differ_from_seed_to_seed_and_from_one_another() -> None:
    tracks = []
    for seed in (1, 1, 2):
        driver = ready(APARTMENT, seed=seed, walkers=2)
        driver.clock.wait_until(30.0)
        tracks.append(driver.truth().people())
    assert np.array_equal(tracks[0], tracks[1])
    assert not np.allclose(tracks[0], tracks[2])
    assert not np.allclose(tracks[0][0], tracks[0][1])


def ways_of_walkers(driver: Sim2d, duration_s: float, period_s: float = 0.05) -> NDArray[np.float64]:
    """(T, K, 5) what the truth tells about people, every period."""
    states = []
    for step in range(round(duration_s / period_s)):
        driver.clock.wait_until(step * period_s)
        states.append(driver.truth().people())
    return np.array(states)


def test_walkers_keep_their_clearance_and_their_speed_and_get_about() -> None:
    driver = ready(APARTMENT, walkers=6, walker_radius=0.2, walker_speed=1.0, beams=1, imu_rate=1)
    ways = ways_of_walkers(driver, 200.0)
    world = load_world(APARTMENT)
    clearance = [world.clearance_m(x, y) for x, y in ways[:, :, :2].reshape(-1, 2)]
    assert min(clearance) >= 0.2
    assert ways[1:, :, 4] == pytest.approx(0.2)
    speeds = np.hypot(ways[1:, :, 2], ways[1:, :, 3])
    assert speeds.max() <= 1.0 + 1e-9
    assert np.median(speeds) == pytest.approx(1.0)
    moved = np.hypot(*np.moveaxis(np.diff(ways[:, :, :2], axis=0), 2, 0)) / 0.05
    assert moved.max() <= 1.0 + 1e-9
    assert np.hypot(*(ways[0, :, :2] - driver.start.xy).T).min() >= 2.0
    rooms = {(int(x // 3.7), int(y // 2.8)) for x, y in ways[:, :, :2].reshape(-1, 2)}
    assert len(rooms) == 9


def test_walkers_walk_on_coarse_maps_too(tmp_path: Path) -> None:
    cells = np.full((40, 40), FREE, dtype=np.int8)
    cells[:18, 20] = cells[23:, 20] = OCCUPIED
    world = write_map(OccupancyGrid(cells, 0.2, (-4.0, -4.0)), tmp_path)[1]
    driver = ready(world, Pose2(-2.0, 0.0, 0.0), walkers=3, walker_radius=0.1, beams=1)
    ways = ways_of_walkers(driver, 60.0)[:, :, :2].reshape(-1, 2)
    assert min(load_world(world).clearance_m(x, y) for x, y in ways) >= 0.1
    assert ways[:, 0].min() < -1.0
    assert ways[:, 0].max() > 1.0


def test_walkers_begin_anywhere_where_the_world_is_too_small_for_their_distance(tmp_path: Path) -> None:
    path = tmp_path / "cell.yaml"
    path.write_text("format: explore-bt-world/1\nbounds: [0, 0, 1.5, 1.5]\nstart: [0.75, 0.75, 0]\n")
    driver = ready(path, walkers=2)
    ways = ways_of_walkers(driver, 20.0)[:, :, :2]
    assert 0.3 <= ways.min() <= ways.max() <= 1.2
    assert np.ptp(ways, axis=0).min() > 0.3


def test_walkers_without_floor_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "cell.yaml"
    path.write_text("format: explore-bt-world/1\nbounds: [0, 0, 1.5, 1.5]\nstart: [0.75, 0.75, 0]\n")
    with pytest.raises(
        WorldError, match=r"find no free floor that is 2.10 m wide; make walker_radius smaller"
    ):
        ready(path, walkers=1, walker_radius=1.0)


def test_a_person_walks_there_and_back_with_pauses(tmp_path: Path) -> None:
    ada = "{name: ada, route: [[0, 1], [3, 1], [3, 5]], speed: 1, pause: 2, begin: 1}"
    driver = ready(field(tmp_path, f"[{ada}]"), beams=1)
    # at (3, 1) from 4 s to 6 s, at (3, 5) from 10 s to 12 s, back at (3, 1) at 16 s, at (0, 1) at 21 s
    for time, x, y, vx, vy in [
        (0.5, 0, 1, 0, 0),
        (3.0, 2, 1, 1, 0),
        (5.0, 3, 1, 0, 0),
        (8.0, 3, 3, 0, 1),
        (11.0, 3, 5, 0, 0),
        (14.0, 3, 3, 0, -1),
        (17.0, 3, 1, 0, 0),
        (19.0, 2, 1, -1, 0),
        (22.0, 0, 1, 0, 0),
        (24.0, 1, 1, 1, 0),
    ]:
        driver.clock.wait_until(time)
        assert driver.truth().people()[0] == pytest.approx([x, y, vx, vy, 0.25], abs=1e-9)


def test_nobody_is_about_in_a_world_without_people() -> None:
    truth = ready(ROOM).truth()
    assert truth.people().shape == (0, 5)
    assert truth.touched_by_people() == 0


def counts(driver: Sim2d) -> tuple[int, int]:
    return driver.truth().contacts(), driver.truth().touched_by_people()


def test_a_person_who_walks_into_the_resting_robot_is_no_contact_of_the_robot(tmp_path: Path) -> None:
    driver = ready(field(tmp_path, "[{name: ada, route: [[-2, 0.3], [2, 0.3]], speed: 1}]"))
    drive(driver, Twist2(), 1.5)
    assert counts(driver) == (0, 0)
    drive(driver, Twist2(), 0.5)
    assert counts(driver) == (0, 1)
    drive(driver, Twist2(), 6.0)
    assert counts(driver) == (0, 2)
    assert driver.truth().pose() == driver.start


def test_a_robot_that_runs_into_somebody_has_one_contact_until_they_part(tmp_path: Path) -> None:
    driver = ready(field(tmp_path, "[{name: ada, route: [[2, 0], [2, 9]], begin: 1 h}]"))
    drive(driver, Twist2(0.5, 0.0), 3.0)
    assert counts(driver) == (0, 0)
    drive(driver, Twist2(0.5, 0.0), 2.0)
    assert driver.truth().pose().x > 1.6
    drive(driver, Twist2(), 2.0)
    assert counts(driver) == (1, 0)
    drive(driver, Twist2(-0.5, 0.0), 3.0)
    drive(driver, Twist2(0.5, 0.0), 3.0)
    assert counts(driver) == (2, 0)


def test_a_touch_becomes_a_contact_when_the_robot_begins_to_move(tmp_path: Path) -> None:
    driver = ready(field(tmp_path, "[{name: ada, route: [[0, 2], [0, 0.4]], speed: 1, pause: 10}]"))
    drive(driver, Twist2(), 3.0)
    assert counts(driver) == (0, 1)
    drive(driver, Twist2(0.04, 0.5), 1.0)
    assert counts(driver) == (0, 1)
    drive(driver, Twist2(0.2, 0.0), 0.5)
    assert counts(driver) == (1, 0)


def test_touches_are_those_of_a_search_through_all_steps(tmp_path: Path) -> None:
    people = ", ".join(
        f"{{name: p{k}, route: [[{1.5 * math.cos(k):.3f}, {1.5 * math.sin(k):.3f}], "
        f"[{-1.5 * math.cos(k):.3f}, {-1.4 * math.sin(k):.3f}]], speed: {0.5 + 0.3 * k}}}"
        for k in range(4)
    )
    driver = ready(field(tmp_path, f"[{people}]"), beams=1)
    gaps, speeds, last = [], [], driver.start
    for step in range(1, 3001):
        driver.command(Twist2(0.3 if step % 700 < 350 else 0.0, 1.2))
        driver.clock.wait_until(step * 0.01)
        pose, now = driver.truth().pose(), driver.truth().people()
        gaps.append(np.hypot(now[:, 0] - pose.x, now[:, 1] - pose.y) - 0.5)
        speeds.append(last.distance_to(pose) / 0.01)
        last = pose
    contacts, stood = 0, 0
    for gap in np.array(gaps).T:
        ends = [i for i, g in enumerate(gap) if g > 0.005]
        for begin, end in pairwise([-1, *ends, len(gap)]):
            touch = [i for i in range(begin + 1, end) if gap[i] < 0.0]
            if touch:
                moved = max(speeds[touch[0] : end]) > 0.05
                contacts, stood = contacts + moved, stood + (not moved)
    assert contacts > 3
    assert stood > 3
    assert counts(driver) == (contacts, stood)


@pytest.mark.parametrize(
    ("material", "ahead_m"), [("matt", 2.0), ("mirror", 2.0 + 2.0 + 3.0 - 0.3), ("glass", 4.0 - 0.2)]
)
def test_people_are_seen_through_glass_and_in_mirrors(tmp_path: Path, material: str, ahead_m: float) -> None:
    ada = "{name: ada, route: [[-3, 0], [-3, 0.1]], radius: 0.3, begin: 1 h}"
    bob = "{name: bob, route: [[4, 0], [4, 0.1]], radius: 0.2, begin: 1 h}"
    path = field(tmp_path, f"[{ada}, {bob}]")
    pane = f"walls: [{{path: [[2.05, -1], [2.05, 1]], material: {material}}}]\n"
    path.write_text(path.read_text() + pane)
    scan = scans(drive(ready(path, noise=False, beams=360, lidar_range=9), Twist2(), 0.1))[0]
    assert scan.ranges_m[180] == pytest.approx(ahead_m, abs=1e-5)
    assert scan.ranges_m[0] == pytest.approx(2.7, abs=1e-5)
