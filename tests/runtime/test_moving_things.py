"""Scenes with discs that walk through a room, scanned beam by beam from a robot that drives and turns."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from explore_bt.runtime.moving_things import MovingThings
from explore_bt.runtime.sight import Sight
from explore_bt.types import UNKNOWN, MovingObstacle, OccupancyGrid, Pose2, Scan2D, Twist2

ROOM = (-4.0, -3.0, 4.0, 3.0)
PERIOD_S = 0.1
RADIUS_M = 0.25
BEAMS = 360
ANGLES = -np.pi + np.arange(BEAMS) * 2.0 * np.pi / BEAMS
UNKNOWN_FLOOR = OccupancyGrid(np.full((160, 200), UNKNOWN, dtype=np.int8), 0.05, (-5.0, -4.0))
STILL, CENTRE = Twist2(), Pose2.identity()
TIMES = (np.arange(BEAMS) + 1.0 - BEAMS) / BEAMS * PERIOD_S


def driven(start: Pose2, twist: Twist2, time_s: float) -> Pose2:
    middle = start.yaw_rad + 0.5 * twist.angular_rps * time_s
    way = twist.linear_mps * time_s
    return Pose2(
        start.x + way * math.cos(middle),
        start.y + way * math.sin(middle),
        start.yaw_rad + twist.angular_rps * time_s,
    )


def beam_m(pose: Pose2, angle: float, discs: list[tuple[float, float]]) -> float:
    direction = pose.yaw_rad + angle
    dx, dy = math.cos(direction), math.sin(direction)
    walls = [
        (edge - place) / d
        for place, d, edges in ((pose.x, dx, ROOM[0::2]), (pose.y, dy, ROOM[1::2]))
        for edge in edges
        if abs(d) > 1e-9 and (edge - place) / d > 0.0
    ]
    found = min(walls)
    for x, y in discs:
        along = (x - pose.x) * dx + (y - pose.y) * dy
        aside = (x - pose.x) * dy - (y - pose.y) * dx
        if along > 0.0 and abs(aside) < RADIUS_M:
            found = min(found, along - math.sqrt(RADIUS_M**2 - aside**2))
    return found


class Scene:
    """Walkers on straight lines, a robot with a constant twist, noise of 1 cm."""

    def __init__(
        self,
        walkers: list[tuple[tuple[float, float], tuple[float, float]]],
        twist: Twist2 = STILL,
        seed: int = 0,
        start: Pose2 = CENTRE,
    ) -> None:
        self._walkers, self._twist, self._start = walkers, twist, start
        self._rng, self._grid = np.random.default_rng(seed), UNKNOWN_FLOOR
        self.things = MovingThings()
        self.time_s = 0.0

    def places(self, time_s: float) -> list[tuple[float, float]]:
        return [(x + vx * time_s, y + vy * time_s) for (x, y), (vx, vy) in self._walkers]

    def _measured(self, angle: float, time_s: float) -> float:
        now_s = self.time_s + time_s
        return beam_m(driven(self._start, self._twist, now_s), angle, self.places(now_s))

    def run(self, duration_s: float) -> tuple[MovingObstacle, ...]:
        found: tuple[MovingObstacle, ...] = ()
        for _ in range(round(duration_s / PERIOD_S)):
            self.time_s += PERIOD_S
            ranges = np.array([self._measured(*beam) for beam in zip(ANGLES, TIMES, strict=True)])
            ranges += self._rng.normal(0.0, 0.01, BEAMS)
            ranges = np.where(ranges > 5.0, np.inf, ranges)
            ranges[self._rng.random(BEAMS) < 0.002] = np.nan
            scan = Scan2D(self.time_s, ANGLES, ranges.astype(np.float32), TIMES, 0.02, 5.0)
            sight = Sight.of(scan, driven(self._start, self._twist, self.time_s), self._twist)
            assert sight is not None
            found = self.things.see(sight, self._grid)
        return found


@pytest.mark.parametrize("twist", [Twist2(), Twist2(0.5, 0.0), Twist2(0.0, 1.2), Twist2(0.3, -0.8)], ids=str)
def test_an_empty_room_moves_nowhere(twist: Twist2) -> None:
    scene = Scene([], twist, start=Pose2(-2.0, 0.0, 0.0))
    for _ in range(40):
        assert scene.run(PERIOD_S) == ()


@settings(max_examples=15, deadline=None)
@given(
    st.floats(0.0, 2.0 * np.pi),
    st.floats(0.5, 1.6),
    st.sampled_from([Twist2(), Twist2(0.3, 0.5), Twist2(0.0, -1.2)]),
    st.integers(0, 1000),
)
def test_who_walks_by_is_followed(course: float, speed: float, twist: Twist2, seed: int) -> None:
    """Past the robot at 1.2 m; after 1 s of it the place is right to a body's width, the velocity roughly."""
    along = np.array([math.cos(course), math.sin(course)])
    begin = 1.2 * np.array([-along[1], along[0]]) - 0.8 * speed * along
    velocity = speed * along
    scene = Scene([((begin[0], begin[1]), (velocity[0], velocity[1]))], twist, seed)
    (found,) = scene.run(1.4)
    (place,) = scene.places(scene.time_s)
    assert math.dist(found.xy, place) < RADIUS_M + 0.1
    assert math.dist(found.velocity_mps, velocity.tolist()) < 0.5 * speed + 0.1


def test_who_comes_straight_on_is_noticed_within_half_a_second() -> None:
    """From 2.5 m at 1.2 m/s; what the robot may count on ends before the body does."""
    scene = Scene([((2.5, 0.0), (-1.2, 0.0))])
    scene.run(0.4)
    noticed_s = next(t for t in np.arange(0.5, 2.0, PERIOD_S) if scene.run(PERIOD_S))
    assert noticed_s < 1.0
    (found,) = scene.run(0.3)
    surface_m = math.dist((0.0, 0.0), scene.places(scene.time_s)[0]) - RADIUS_M
    assert found.least_distance_m(Pose2.identity(), scene.time_s, 1.6) <= surface_m + 0.05


def test_who_pauses_is_held_for_a_while_and_then_left_to_the_map() -> None:
    scene = Scene([((-1.5, 1.0), (1.0, 0.0))])
    (walking,) = scene.run(1.5)
    scene._walkers = [((scene.places(1.5)[0]), (0.0, 0.0))]
    (paused,) = scene.run(2.0)
    assert paused.number == walking.number
    assert math.hypot(*paused.velocity_mps) < 0.3
    assert scene.run(6.0) == ()


def test_two_who_meet_keep_their_numbers() -> None:
    scene = Scene([((-2.0, 1.0), (1.0, 0.0)), ((2.0, 2.0), (-1.0, 0.0))])
    first = {thing.number for thing in scene.run(1.2)}
    assert len(first) == 2
    assert {thing.number for thing in scene.run(1.8)} == first


def test_a_corrected_pose_makes_it_forget() -> None:
    scene = Scene([((-1.5, 1.0), (1.0, 0.0))])
    assert scene.run(1.5)
    scene.things.forget()
    assert scene.run(PERIOD_S) == ()


def test_in_open_space_nothing_comes_back_and_nothing_moves() -> None:
    scan = Scan2D(0.0, ANGLES, np.full(BEAMS, np.inf, dtype=np.float32), TIMES, 0.02, 5.0)
    for stamp_s in (0.1, 0.2, 0.3):
        sight = Sight.of(replace(scan, stamp_s=stamp_s), CENTRE, STILL)
        assert sight is not None
        assert MovingThings().see(sight, UNKNOWN_FLOOR) == ()


def test_a_blind_scan_is_no_sight() -> None:
    scan = Scan2D(0.0, ANGLES, np.full(BEAMS, np.nan, dtype=np.float32), TIMES, 0.02, 5.0)
    assert Sight.of(scan, CENTRE, STILL) is None
