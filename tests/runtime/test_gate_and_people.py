"""People who walk straight at the robot, whatever it does: it may be touched, it never runs into anyone."""

import math
from collections import deque
from dataclasses import replace

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from explore_bt.interfaces import HeldBy, Surroundings
from explore_bt.runtime.safety_gate import AT_REST_MPS, MAP_ERROR_M, STARTING_MPS2, SafetyGate
from explore_bt.testing.fake_robot import open_floor
from explore_bt.types import (
    FREE,
    OCCUPIED,
    MotionLimits,
    MotionState,
    MovingObstacle,
    OccupancyGrid,
    Pose2,
    Twist2,
)

from .conftest import DT, LIMITS, towards

RADIUS, BODY = 0.25, 0.25
VELOCITY_OFF_MPS = 0.5
SCAN_EVERY = 2
PARTS = 5
FLOOR = open_floor(30.0, 0.1)
FIRM = replace(LIMITS, acceleration_mps2=2.5, jerk_mps3=30.0)


class Chase:
    """A robot that wants to drive straight on, and people who turn on it as quickly as they can.

    The body is ``lag_parts`` fifths of a period behind ``pose``, where its commands lead to.
    They begin with ``velocities``; the gate is told others, wrong by as much as it allows for.
    """

    def __init__(
        self,
        people: np.ndarray,
        speed_mps: float,
        velocities: np.ndarray | None = None,
        lag_parts: int = 0,
        brake: MotionLimits = LIMITS,
    ) -> None:
        delay_s = lag_parts * DT / PARTS
        self.gate, self.motion = SafetyGate(RADIUS, brake, delay_s), MotionState()
        self.pose, self.lagging = Pose2.identity(), deque([(Pose2.identity(), 0.0)] * (lag_parts + 1))
        self.people, self.speed_mps = people.astype(float), speed_mps
        self.velocities = np.zeros_like(self.people) if velocities is None else velocities
        self.time_s, self.steps = 0.0, 0
        self.held_by = HeldBy.NOTHING
        self.fastest_touch_mps = 0.0

    def step(self, wanted: Twist2) -> None:
        if self.steps % SCAN_EVERY == 0:
            moving = tuple(
                MovingObstacle(k, (x, y), (vx, vy), BODY, self.time_s, VELOCITY_OFF_MPS)
                for k, (x, y, vx, vy) in enumerate(np.hstack([self.people, self._told()]).tolist())
            )
            self.gate.see(Surroundings(self.time_s, np.empty((0, 2)), FLOOR, moving), self.pose)
        wish = towards(wanted, self.motion)
        decision = self.gate.decide(wish, self.pose, self.motion, DT, self.time_s)
        self.held_by = decision.held_by
        self._move(decision.motion)
        self.motion = decision.motion
        self.time_s += DT
        self.steps += 1

    def _told(self) -> np.ndarray:
        """Velocities that lead away from the robot more than the true ones."""
        off = self.people - np.array(self.pose.xy)
        return self.velocities + VELOCITY_OFF_MPS * off / np.maximum(np.hypot(*off.T)[:, None], 1e-9)

    def _walk(self, dt_s: float) -> None:
        off = np.array(self.lagging[0][0].xy) - self.people
        wanted = self.speed_mps * off / np.maximum(np.hypot(*off.T)[:, None], 1e-9)
        change = wanted - self.velocities
        most = STARTING_MPS2 * dt_s
        self.velocities += change * np.minimum(1.0, most / np.maximum(np.hypot(*change.T)[:, None], 1e-9))
        self.people += self.velocities * dt_s

    def _move(self, following: MotionState) -> None:
        before = self.motion.twist
        for k in range(PARTS):
            share = (k + 0.5) / PARTS
            v = before.linear_mps + share * (following.twist.linear_mps - before.linear_mps)
            w = before.angular_rps + share * (following.twist.angular_rps - before.angular_rps)
            yaw = self.pose.yaw_rad + 0.5 * w * DT / PARTS
            step = v * DT / PARTS
            self.pose = Pose2(
                self.pose.x + step * math.cos(yaw),
                self.pose.y + step * math.sin(yaw),
                self.pose.yaw_rad + w * DT / PARTS,
            )
            self._walk(DT / PARTS)
            self.lagging.append((self.pose, v))
            self.lagging.popleft()
            body, body_v = self.lagging[0]
            away = np.hypot(*(np.array(body.xy) - self.people).T)
            if float(away.min()) < RADIUS + BODY:
                self.fastest_touch_mps = max(self.fastest_touch_mps, abs(body_v))


@given(
    st.lists(
        st.tuples(st.floats(-math.pi, math.pi), st.floats(1.0, 6.0), st.floats(-math.pi, math.pi)),
        min_size=1,
        max_size=4,
    ),
    st.floats(0.3, 1.6),
    st.floats(-0.3, 0.5),
    st.floats(-1.2, 1.2),
    st.sampled_from([0, 22]),
    st.sampled_from([LIMITS, FIRM]),
)
@settings(deadline=None, max_examples=120)
def test_whoever_comes_the_robot_stands_before_they_meet(
    places: list[tuple[float, float, float]],
    speed: float,
    v: float,
    w: float,
    lag_parts: int,
    brake: MotionLimits,
) -> None:
    people = np.array([(away * math.cos(at), away * math.sin(at)) for at, away, _ in places])
    courses = np.array([(math.cos(course), math.sin(course)) for _, _, course in places])
    chase = Chase(people, speed, speed * courses, lag_parts, brake)
    for _ in range(100):
        chase.step(Twist2(v, w))
    assert chase.fastest_touch_mps <= AT_REST_MPS


def test_someone_far_off_does_not_slow_the_robot_down() -> None:
    chase = Chase(np.array([[0.0, 5.0]]), 0.0)
    for _ in range(40):
        chase.step(Twist2(0.5, 0.0))
        assert chase.held_by is HeldBy.NOTHING
    assert chase.motion.twist.linear_mps > 0.49


def test_the_nearer_someone_is_the_slower_it_passes() -> None:
    fastest = []
    for aside in (0.8, 1.2, 1.6, 2.4):
        chase, speeds = Chase(np.array([[2.0, aside]]), 0.0), [0.0]
        for _ in range(400):
            chase.step(Twist2(0.5, 0.0))
            if abs(chase.pose.x - 2.0) < 0.2:
                speeds.append(chase.motion.twist.linear_mps)
        fastest.append(max(speeds))
    assert fastest == sorted(fastest)
    assert fastest[0] < 0.25 < 0.45 < fastest[-1]


def test_the_firmer_the_brake_the_nearer_someone_may_be() -> None:
    nearest = []
    for brake in (LIMITS, FIRM):
        chase, gaps = Chase(np.array([[6.0, 0.0]]), 1.2, brake=brake), [6.0]
        while chase.time_s < 5.0:
            chase.step(Twist2(0.5, 0.0))
            if chase.motion.twist.linear_mps > 0.3:
                gaps.append(float(np.hypot(*(chase.people[0] - chase.pose.xy))) - RADIUS - BODY)
        nearest.append(min(gaps))
    assert nearest[1] < 0.6 * nearest[0]


def test_who_walks_away_lets_the_robot_go_faster_than_who_comes() -> None:
    fastest = []
    for course in (-1.2, 0.0, 1.2):
        chase, speeds = Chase(np.array([[1.6, 0.0]]), 0.0), [0.0]
        for _ in range(40):
            chase.people, chase.velocities = np.array([[chase.pose.x + 1.6, 0.0]]), np.array([[course, 0.0]])
            chase.step(Twist2(0.5, 0.0))
            speeds.append(chase.motion.twist.linear_mps)
        fastest.append(max(speeds))
    assert fastest[0] < fastest[2]
    assert fastest == sorted(fastest)


def test_who_has_come_up_to_the_robot_is_waited_for_although_nobody_is_seen() -> None:
    chase = Chase(np.array([[0.49, 0.0]]), 0.0)
    for _ in range(10):
        chase.step(Twist2(0.5, 0.0))
    chase.people += 20.0
    for _ in range(10):
        chase.step(Twist2(0.5, 0.0))
        assert chase.motion.twist.linear_mps <= AT_REST_MPS + 1e-9
    for _ in range(20):
        chase.step(Twist2(0.5, 0.0))
    assert chase.motion.twist.linear_mps > 0.2


def test_turning_on_the_spot_is_always_allowed() -> None:
    chase = Chase(np.array([[0.6, 0.0]]), 0.0)
    for _ in range(20):
        chase.step(Twist2(0.0, 0.5))
        assert chase.held_by is HeldBy.NOTHING


def test_who_is_lost_from_sight_beside_a_standing_robot_holds_it_a_little_longer() -> None:
    chase = Chase(np.array([[0.62, 0.0]]), 0.0)
    for _ in range(40):
        chase.step(Twist2(0.5, 0.0))
    chase.people += 20.0
    for _ in range(4):
        chase.step(Twist2(0.5, 0.0))
        assert chase.motion.twist.linear_mps <= AT_REST_MPS + 1e-9
    for _ in range(20):
        chase.step(Twist2(0.5, 0.0))
    assert chase.motion.twist.linear_mps > 0.2


def test_who_is_told_of_is_named_as_the_reason() -> None:
    chase, reasons = Chase(np.array([[1.0, 0.0]]), 0.0), set()
    for _ in range(60):
        chase.step(Twist2(0.5, 0.0))
        reasons.add(chase.held_by)
    assert reasons == {HeldBy.NOTHING, HeldBy.SOMEONE}
    assert chase.pose.x < 0.5


def test_a_wall_beside_someone_is_still_a_wall() -> None:
    """Their returns do not vote, and some of the wall's with them: then the map has to answer for it."""
    cells = np.full((100, 100), FREE, dtype=np.int8)
    cells[:, 58:] = OCCUPIED
    walled = OccupancyGrid(cells, 0.05, (-2.5, -2.5))
    wall = np.column_stack((np.full(50, 0.4), np.linspace(-2.0, 2.0, 50)))
    someone = MovingObstacle(0, (0.85, 0.3), (0.0, 0.0), 0.45, 0.0)
    gate, motion, x = SafetyGate(RADIUS, LIMITS), MotionState(), -0.1
    for _ in range(300):
        gate.see(Surroundings(0.0, wall, walled, (someone,)), Pose2(x, 0.0, 0.0))
        motion = gate.decide(towards(Twist2(0.04, 0.0), motion), Pose2(x, 0.0, 0.0), motion, DT, 0.0).motion
        x += motion.twist.linear_mps * DT
    assert 0.0 < x <= 0.4 - RADIUS - MAP_ERROR_M
