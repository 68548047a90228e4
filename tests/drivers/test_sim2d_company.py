"""Several robots in one world."""

import itertools
import math
from pathlib import Path

import numpy as np
import pytest
from explore_bt_drivers import Sim2d, Sim2dOptions

from explore_bt.errors import WorldError
from explore_bt.interfaces import Commons, RobotContext
from explore_bt.types import Measurement, Pose2, Scan2D, Twist2

from .conftest import prints

FIELD = "format: explore-bt-world/1\nbounds: [-10, -10, 10, 10]\nstart: [0, 0, 0]\n"


def field(folder: Path, more: str = "") -> Path:
    path = folder / "field.yaml"
    path.write_text(FIELD + more)
    return path


def robots(world: Path, *starts: Pose2 | None, **options: object) -> list[Sim2d]:
    """One mission's robots r0, r1, ... in one world, exact sensors unless asked otherwise."""
    commons = Commons()
    drivers = []
    for number, start in enumerate(starts):
        driver = Sim2d(Sim2dOptions.model_validate({"world": world, "noise": False, **options}))
        driver.setup(RobotContext(robot=f"r{number}", seed=3, start=start, commons=commons))
        drivers.append(driver)
    return drivers


def drive(
    drivers: list[Sim2d], twists: list[Twist2], duration_s: float, period_s: float = 0.05
) -> list[list[Measurement]]:
    """All of them in lock-step, as the tick loop does it."""
    measured: list[list[Measurement]] = [[] for _ in drivers]
    begin_s = drivers[0].clock.now_s()
    for period in range(1, round(duration_s / period_s) + 1):
        for driver, twist in zip(drivers, twists, strict=True):
            driver.command(twist)
        for driver in drivers:
            driver.clock.wait_until(begin_s + period * period_s)
        for driver, own in zip(drivers, measured, strict=True):
            own += driver.read()
    return measured


def pose(driver: Sim2d) -> Pose2:
    truth = driver.truth()
    assert truth is not None
    return truth.pose()


def contacts(driver: Sim2d) -> int:
    truth = driver.truth()
    assert truth is not None
    return truth.contacts()


def test_a_robot_at_rest_is_seen_as_a_disc_by_another(tmp_path: Path) -> None:
    one, other = robots(field(tmp_path), Pose2(0, 0, 0), Pose2(2, 0.5, 1), radius=0.3)
    measured = drive([one, other], [Twist2(), Twist2()], 0.2)
    scan = next(m for m in measured[0] if isinstance(m, Scan2D))
    hits = scan.points()[scan.ranges_m[np.isfinite(scan.ranges_m)] < 4.0]
    assert len(hits) > 10
    assert np.hypot(hits[:, 0] - 2.0, hits[:, 1] - 0.5) == pytest.approx(0.3, abs=1e-5)
    bearing = np.arctan2(hits[:, 1], hits[:, 0])
    half = math.asin(0.3 / math.hypot(2.0, 0.5))
    assert np.ptp(bearing) == pytest.approx(2 * half, abs=2 * math.radians(1.0))


def test_a_sweep_meets_the_other_where_it_was_at_each_beams_time(tmp_path: Path) -> None:
    one, other = robots(field(tmp_path), Pose2(0, 0, 0), Pose2(2, -1, math.pi / 2), lidar_rate=2)
    ways: list[tuple[float, Pose2]] = []
    last: Scan2D | None = None
    for _ in range(300):
        other.command(Twist2(0.5, 0.0))
        one.clock.wait_until(one.clock.now_s() + 0.01)
        ways.append((one.clock.now_s(), pose(other)))
        last = next((m for m in reversed(one.read()) if isinstance(m, Scan2D)), last)
    assert last is not None
    seen = np.flatnonzero(last.ranges_m < 4.0)
    times = last.stamp_s + last.times_s[seen]
    stamps = [stamp for stamp, _ in ways]
    x, y = (np.interp(times, stamps, [getattr(at, axis) for _, at in ways]) for axis in "xy")
    bearings = last.angles_rad[seen]
    points = last.ranges_m[seen, None] * np.column_stack((np.cos(bearings), np.sin(bearings)))
    assert len(seen) > 5
    assert np.hypot(points[:, 0] - x, points[:, 1] - y) == pytest.approx(0.25, abs=1e-4)


def test_robots_that_meet_head_on_stand_and_the_contact_counts_on_both_sides(tmp_path: Path) -> None:
    pair = robots(field(tmp_path), Pose2(-1, 0, 0), Pose2(1, 0.1, math.pi))
    drive(pair, [Twist2(0.5, 0.0)] * 2, 5.0)
    assert [contacts(driver) for driver in pair] == [1, 1]
    gap_m = pose(pair[0]).distance_to(pose(pair[1])) - 0.5
    assert -2e-6 <= gap_m < 0.01
    drive(pair, [Twist2(-0.3, 0.0)] * 2, 1.0)
    drive(pair, [Twist2(0.3, 0.0)] * 2, 3.0)
    assert [contacts(driver) for driver in pair] == [2, 2], "5 mm apart and together again is another contact"


def test_discs_never_overlap_however_many_push(tmp_path: Path) -> None:
    starts = [Pose2(1.2 * math.cos(a), 1.2 * math.sin(a), a + math.pi) for a in np.arange(6) * math.pi / 3]
    ring = robots(field(tmp_path), *starts)
    for _ in range(8):
        drive(ring, [Twist2(0.5, 0.2 * (-1) ** k) for k in range(6)], 0.5)
        for one, other in itertools.combinations(ring, 2):
            assert pose(one).distance_to(pose(other)) >= 0.5 - 2e-6
    assert all(contacts(driver) for driver in ring)


@pytest.mark.parametrize("period_s", [0.05, 0.01, 0.37])
def test_what_happens_does_not_depend_on_how_the_waiting_is_cut_up(tmp_path: Path, period_s: float) -> None:
    world = field(tmp_path)
    results = []
    for cut in (0.1, period_s):
        pair = robots(world, Pose2(-1, 0, 0), Pose2(1, 0.2, math.pi))
        for driver in pair:
            driver.command(Twist2(0.5, 0.1))
        for time_s in [*np.arange(cut, 0.45, cut), 0.45]:
            pair[0].clock.wait_until(float(time_s))
        results.append([prints(list(driver.read())) for driver in pair] + [pose(driver) for driver in pair])
    assert results[0] == results[1]


def test_the_same_seed_and_commands_give_all_robots_the_same_measurements(tmp_path: Path) -> None:
    world = field(tmp_path)
    runs = []
    for _ in range(2):
        pair = robots(world, Pose2(-1, 0, 0), Pose2(1, 0.1, math.pi), noise=True, walkers=2)
        runs.append([prints(own) for own in drive(pair, [Twist2(0.4, 0.3), Twist2(0.4, -0.2)], 3.0)])
    assert runs[0] == runs[1]
    assert runs[0][0] != runs[0][1]


def test_all_robots_of_a_mission_meet_the_same_people(tmp_path: Path) -> None:
    pair = robots(field(tmp_path), Pose2(-1, 0, 0), Pose2(1, 0, 0), walkers=3)
    drive(pair, [Twist2()] * 2, 4.0)
    people = [truth.people() for truth in (driver.truth() for driver in pair) if truth is not None]
    assert len(people[0]) == 3
    assert np.array_equal(people[0], people[1])


def test_missions_do_not_meet(tmp_path: Path) -> None:
    world = field(tmp_path)
    (alone,), (stranger,) = robots(world, Pose2(0, 0, 0)), robots(world, Pose2(0.3, 0, 0))
    drive([alone], [Twist2(0.5, 0.0)], 2.0)
    assert contacts(alone) == contacts(stranger) == 0


def test_robots_without_a_start_begin_side_by_side(tmp_path: Path) -> None:
    starts = [driver.start for driver in robots(field(tmp_path), None, None, None, None)]
    assert starts[0] == Pose2(0, 0, 0)
    for one, other in itertools.combinations(starts, 2):
        assert 0.5 + 0.7 - 0.05 <= one.distance_to(other) < 3.0


def test_a_start_that_is_taken_is_refused_with_who_stands_there(tmp_path: Path) -> None:
    with pytest.raises(WorldError, match=r"\(0\.30, 0\.00\) is taken: robot r0 .* 0\.50 m or more apart"):
        robots(field(tmp_path), Pose2(0, 0, 0), Pose2(0.3, 0, 0))


def test_robots_that_ask_for_different_people_in_one_world_are_refused(tmp_path: Path) -> None:
    world, commons = field(tmp_path), Commons()
    one, other = (Sim2d(Sim2dOptions.model_validate({"world": world, "walkers": n})) for n in (1, 2))
    one.setup(RobotContext(robot="one", commons=commons))
    with pytest.raises(WorldError, match="other asks for walkers = 2, robot one in the same world for 1"):
        other.setup(RobotContext(robot="other", commons=commons))


def test_a_thing_waits_until_every_robot_is_out_of_its_place(tmp_path: Path) -> None:
    moved = "furniture: [{name: chair, box: [6, 6, 6.4, 6.4], moved: [{at: 0.5, to: [1.8, -0.2]}]}]\n"
    far, near = robots(field(tmp_path, moved), Pose2(-5, 0, 0), Pose2(2, 0, 0))
    drive([far, near], [Twist2()] * 2, 1.0)
    assert contacts(near) == 0
    truth = near.truth()
    assert truth is not None
    assert truth.clearance_m() > 1.0, "the chair is not put down on a robot"
    drive([far, near], [Twist2(), Twist2(0.5, 0.0)], 4.0)
    assert pose(near).x > 3.0
    assert truth.clearance_m() == pytest.approx(pose(near).x - 2.0, abs=0.01), "the chair came later"
