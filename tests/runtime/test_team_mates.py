"""Robots that keep clear of one another by what they tell."""

import itertools
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from explore_bt.errors import NoPath
from explore_bt.interfaces import HeldBy, Surroundings
from explore_bt.runtime.safety_gate import SafetyGate
from explore_bt.runtime.team_mate import (
    fault_by_mates,
    first_path,
    grids_to_try,
    standing,
    with_mates,
    without_mates,
)
from explore_bt.testing.fake_robot import full_circle_scan, open_floor
from explore_bt.types import Mate, MotionState, OccupancyGrid, Path, Pose2, Twist2

from .conftest import DT, LIMITS, towards

RADIUS = 0.25
NOWHERE = np.empty((0, 2))


def mate(xy: tuple[float, float], stop: list[tuple[float, float]] | None = None, **more: object) -> Mate:
    places = np.array([xy, *(stop or [])])
    told = {"stamp_s": 0.0, "binding_s": 0.05, "twist": Twist2(), "ahead": NOWHERE, **more}
    return Mate("bob", T_map_base=Pose2(*xy, 0.0), radius_m=RADIUS, speed_limit_mps=0.5, stop=places, **told)  # type: ignore[arg-type]  # built from a table


class Driven:
    """A robot that does exactly what its gate sends, and tells where it would stop."""

    def __init__(self, name: str, pose: Pose2) -> None:
        self.name, self.pose, self.motion = name, pose, MotionState()
        self.gate = SafetyGate(RADIUS, LIMITS)
        self.gate.see(Surroundings(0.0, np.empty((0, 2)), open_floor()), pose)
        self.told = self.tell(0.0)
        self.reason, self.held_by = "", HeldBy.NOTHING

    def step(self, wanted: Twist2, mates: list[Mate], now_s: float) -> None:
        self.gate.mates = tuple(mates)
        decision = self.gate.decide(towards(wanted, self.motion), self.pose, self.motion, DT, now_s)
        self.reason, self.held_by, motion = decision.reason, decision.held_by, decision.motion
        told_from = self.pose
        mean_v = 0.5 * (self.motion.twist.linear_mps + motion.twist.linear_mps)
        mean_w = 0.5 * (self.motion.twist.angular_rps + motion.twist.angular_rps)
        heading = self.pose.yaw_rad + 0.5 * mean_w * DT
        self.motion = motion
        self.pose = Pose2(
            told_from.x + mean_v * DT * math.cos(heading),
            told_from.y + mean_v * DT * math.sin(heading),
            told_from.yaw_rad + mean_w * DT,
        )
        self.told = self.tell(now_s)

    def tell(self, now_s: float) -> Mate:
        stop = self.gate.stop_places(self.motion, self.pose, DT)
        twist = self.motion.twist
        binding_s = max(now_s + DT, self.gate.stays_until_s)
        return Mate(self.name, now_s, binding_s, self.pose, twist, RADIUS, LIMITS.speed_mps, stop, NOWHERE)


@settings(max_examples=40, deadline=None)
@given(seed=st.integers(0, 100_000), delay=st.sampled_from([0, 0, 2, 6]))
def test_whatever_three_robots_want_they_never_touch(seed: int, delay: int) -> None:
    """Also when each hears the others up to 0.3 s late."""
    rng = np.random.default_rng(seed)
    robots = [Driven(name, Pose2(1.2 * k, 0.3 * k, rng.uniform(-3, 3))) for k, name in enumerate("abc")]
    history = [[robot.told for robot in robots]]
    wishes = [Twist2()] * 3
    for step in range(120):
        if step % 20 == 0:
            wishes = [Twist2(rng.uniform(-0.1, 0.5), rng.uniform(-1, 1)) for _ in robots]
        now_s = step * DT
        for number, robot in enumerate(robots):
            heard = [other.told for other in robots] if not delay else history[max(len(history) - delay, 0)]
            robot.step(wishes[number], [each for each in heard if each.name != robot.name], now_s)
        history.append([robot.told for robot in robots])
        for one, other in itertools.combinations(robots, 2):
            assert one.pose.distance_to(other.pose) >= 2 * RADIUS


def test_who_has_told_that_it_stays_stays_and_may_turn() -> None:
    robot = Driven("a", Pose2(0, 0, 0))
    robot.gate.stays_until_s = 1.0
    robot.step(Twist2(0.5, 0.0), [], 0.9)
    assert (robot.motion.twist.linear_mps, robot.held_by, robot.gate.in_the_way) == (0.0, HeldBy.MATE, "")
    robot.step(Twist2(0.0, 0.5), [], 0.95)
    assert robot.motion.twist.angular_rps > 0.0
    robot.step(Twist2(0.5, 0.0), [], 1.0)
    assert robot.held_by is HeldBy.NOTHING


@pytest.mark.parametrize("lag_s", [0.0, 0.5, 1.0])
def test_two_side_by_side_do_not_hold_each_other_for_ever_however_slow_words_are(lag_s: float) -> None:
    """Both want ahead, past one another at 10 cm; the one whose name comes second lets the other pass."""
    robots = [Driven("a", Pose2(0, 0, 0)), Driven("b", Pose2(1.0, 0.6, math.pi))]
    floor = open_floor()
    history = [[robot.told for robot in robots]]
    for step in range(400):
        now_s = step * DT
        heard = history[max(len(history) - 1 - round(lag_s / DT), 0)]
        for robot, other in ((robots[0], heard[1]), (robots[1], heard[0])):
            lets_pass = robot.name == "b" and robot.held_by is HeldBy.MATE and robot.gate.in_the_way == "a"
            if robot.motion == MotionState() and lets_pass:
                robot.gate.stays_until_s = now_s + lag_s + 0.2
            robot.gate.see(Surroundings(now_s, np.empty((0, 2)), floor), robot.pose)
            robot.step(Twist2(0.3, 0.0), [other], now_s)
        history.append([robot.told for robot in robots])
        assert robots[0].pose.distance_to(robots[1].pose) >= 2 * RADIUS
    assert robots[0].pose.x > 2.0
    assert robots[1].pose.x < -1.0


def test_two_head_on_stand_and_name_each_other() -> None:
    robots = [Driven("a", Pose2(0, 0, 0)), Driven("b", Pose2(3, 0, math.pi))]
    for step in range(200):
        for robot, other in (robots, robots[::-1]):
            robot.step(Twist2(0.5, 0.0), [other.told], step * DT)
    assert robots[0].pose.distance_to(robots[1].pose) < 0.75, "they come near"
    assert all(robot.reason.startswith(f"team mate {other.name}") for robot, other in (robots, robots[::-1]))
    assert [(robot.held_by, robot.gate.in_the_way) for robot in robots] == [
        (HeldBy.MATE, "b"),
        (HeldBy.MATE, "a"),
    ]


@pytest.mark.parametrize(("bob_x", "held_by"), [(0.72, HeldBy.MATE), (-0.8, HeldBy.OBSTACLE)])
def test_returns_just_beside_a_mate_are_its_own_and_all_others_an_obstacle(
    bob_x: float, held_by: HeldBy
) -> None:
    gate = SafetyGate(RADIUS, LIMITS)
    gate.mates = (mate((bob_x, 0.0)),)
    for _ in range(3):
        gate.see(Surroundings(0.0, np.array([(0.251, 0.0)]), open_floor()), Pose2(0, 0, 0))
    decision = gate.decide(towards(Twist2(0.5, 0.0), MotionState()), Pose2(0, 0, 0), MotionState(), DT)
    assert decision.reason
    assert decision.held_by is held_by
    assert gate.in_the_way == ("bob" if held_by is HeldBy.MATE else "")


def test_who_stands_too_near_may_drive_off_and_not_nearer() -> None:
    near = [mate((0.52, 0.0))]
    away = np.column_stack((np.linspace(0.0, -0.3, 10), np.zeros((10, 2))))
    assert fault_by_mates(away, RADIUS, near, 0.0) == ("", "")
    assert fault_by_mates(-away, RADIUS, near, 0.0)[1] == "bob"
    assert fault_by_mates(1e-4 * away, RADIUS, near, 0.0) == ("", ""), "from rest, in one control period"
    assert fault_by_mates(-1e-4 * away, RADIUS, near, 0.0)[1] == "bob"


def test_where_words_are_late_one_that_is_too_near_drives_off_from_rest() -> None:
    """Whatever is told; else two that have come side by side would stand there for good."""
    robot = Driven("a", Pose2(0, 0, 0))
    floor = open_floor()
    for step in range(60):
        robot.gate.see(Surroundings(step * DT, np.empty((0, 2)), floor), robot.pose)
        robot.step(
            Twist2(0.3, 0.0),
            [mate((-0.55, 0.0), stamp_s=step * DT - 1.0, binding_s=step * DT - 1.0)],
            step * DT,
        )
    assert robot.pose.x > 0.5


@pytest.mark.parametrize("bearing_deg", [0, 60, -60])
def test_from_rest_too_near_a_mate_a_robot_drives_off(bearing_deg: float) -> None:
    robot = Driven("a", Pose2(-0.54, 0.0, math.pi + math.radians(bearing_deg)))
    for step in range(60):
        robot.step(
            Twist2(0.3, 0.0), [mate((0.0, 0.0), stamp_s=step * DT, binding_s=(step + 1) * DT)], step * DT
        )
    assert math.dist(robot.pose.xy, (0.0, 0.0)) > 1.0


def test_an_old_word_counts_for_less() -> None:
    way = np.column_stack((np.linspace(0.0, 0.4, 10), np.zeros((10, 2))))
    assert fault_by_mates(way, RADIUS, [mate((1.2, 0.0))], 0.05) == ("", "")
    assert fault_by_mates(way, RADIUS, [mate((1.2, 0.0))], 0.45)[1] == "bob"


def test_the_returns_off_a_mate_are_no_part_of_the_map_and_all_others_stay() -> None:
    ranges = np.full(360, 3.0)
    ranges[171:190] = 1.75  # ahead, the near side of a disc at 2 m
    scan = full_circle_scan(ranges)
    pose = Pose2(1.0, 1.0, math.pi / 2)
    cleared = without_mates(scan, pose, [mate((1.0, 3.0))])
    assert np.isnan(cleared.ranges_m[171:190]).all()
    assert np.array_equal(cleared.ranges_m[190:], scan.ranges_m[190:])
    assert np.array_equal(cleared.ranges_m[:171], scan.ranges_m[:171])
    assert without_mates(scan, pose, [mate((6.0, 6.0))]) is scan


def test_a_mate_that_drives_is_looked_for_where_it_has_come_to() -> None:
    ranges = np.full(360, 3.0)
    ranges[175:185] = 1.75
    moving = mate((1.0, 0.0), twist=Twist2(0.5, 0.0))
    late = full_circle_scan(ranges)
    assert np.isnan(without_mates(late, Pose2(-1.0, 0.0, 0.0), [moving]).ranges_m[175:185]).all()
    object.__setattr__(late, "stamp_s", 2.0)
    assert not np.isnan(without_mates(late, Pose2(-1.0, 0.0, 0.0), [moving]).ranges_m[175:185]).any()


@pytest.mark.parametrize(
    ("told", "goal", "counts"),
    [
        ({}, (5.0, 0.0), True),
        ({"twist": Twist2(0.3, 0.0)}, (5.0, 0.0), False),
        ({"ahead": np.ones((3, 2))}, (5.0, 0.0), False),
        ({"ahead": np.ones((3, 2)), "yields": -1}, (5.0, 0.0), True),
        ({}, (2.2, 0.0), False),
    ],
    ids=["parked", "moves", "waits and goes second", "waits and goes first", "stands on the goal"],
)
def test_a_plan_goes_around_who_will_not_move(
    told: dict[str, object], goal: tuple[float, float], counts: bool
) -> None:
    found = standing([mate((2.0, 0.0), **told)], Pose2(0, 0, 0), Pose2(*goal, 0), (0, "ada"))  # type: ignore[arg-type]  # built from a table
    assert bool(found) == counts


def test_a_mate_is_an_obstacle_as_large_as_it_is_and_leaves_the_robot_its_place() -> None:
    grid = open_floor(6.0, 0.05)
    marked = with_mates(grid, [mate((1.0, 0.0))], Pose2(-2, 0, 0), RADIUS)
    area_m2 = np.count_nonzero(marked.occupied) * 0.05**2
    assert area_m2 == pytest.approx(math.pi * (RADIUS + 0.08) ** 2, rel=0.1)
    beside = with_mates(grid, [mate((1.0, 0.0))], Pose2(0.45, 0, 0), RADIUS)
    cells = beside.centers_of(np.argwhere(beside.occupied))
    assert np.hypot(cells[:, 0] - 0.45, cells[:, 1]).min() > RADIUS


def test_where_the_parked_leave_no_way_the_plan_counts_on_their_going() -> None:
    grid, here = open_floor(6.0, 0.05), Pose2(-2, 0, 0)
    parked, waiting = mate((1.0, 0.0)), mate((0.0, 0.0), ahead=np.ones((3, 2)), yields=-1)
    tried: list[int] = []

    def plan(there: OccupancyGrid) -> Path:
        tried.append(int(np.count_nonzero(there.occupied)))
        if len(tried) == 1:
            raise NoPath("walled in")
        return Path(np.zeros((2, 3)), np.ones(2))

    grids = grids_to_try(grid, [parked, waiting], here, RADIUS)
    chosen, _ = first_path(grids, plan)
    assert chosen is grids[1]
    assert tried[0] > tried[1] > 0, "who waits with the right of way stays in it"
    with pytest.raises(NoPath):
        first_path(grids_to_try(grid, [waiting], here, RADIUS), _refuse)


def _refuse(_: OccupancyGrid) -> Path:
    raise NoPath("walled in")
