"""Rooms, ways through them, and the back end of a robot that was driven there."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence

import numpy as np
from explore_bt_slam.back_end import BackEnd
from explore_bt_slam.sweep import Sweep

from explore_bt.testing.slam_room import Room
from explore_bt.types import Pose2, wrap_angle


def rectangle(x0: float, y0: float, x1: float, y1: float) -> list[list[float]]:
    corners = [(x0, y0), (x1, y0), (x1, y1), (x0, y1)]
    return [[*a, *b] for a, b in zip(corners, corners[1:] + corners[:1], strict=True)]


def ring_of_cupboards() -> Room:
    """A corridor 2 m wide about a core of 46 × 26 m, with cupboards at odd places along the outer wall."""
    rng = np.random.default_rng(3)
    segments = rectangle(-23.0, -13.0, 23.0, 13.0) + rectangle(-25.0, -15.0, 25.0, 15.0)
    for x in np.cumsum(rng.uniform(1.5, 4.0, 17)) - 24.0:
        segments += rectangle(x, -15.0, x + rng.uniform(0.3, 1.0), -15.0 + rng.uniform(0.2, 0.5))
        segments += rectangle(-x, 15.0 - rng.uniform(0.2, 0.5), -x + rng.uniform(0.3, 1.0), 15.0)
    for y in np.cumsum(rng.uniform(1.5, 4.0, 9)) - 13.0:
        segments += rectangle(-25.0, y, -25.0 + rng.uniform(0.2, 0.5), y + rng.uniform(0.3, 1.0))
        segments += rectangle(25.0 - rng.uniform(0.2, 0.5), -y, 25.0, -y + rng.uniform(0.3, 1.0))
    return Room(np.array(segments), np.zeros((0, 3)))


def equal_rooms(count: int) -> Room:
    """Rooms of 3.6 × 3 m, each with the same desk, along a corridor 1.6 m wide: one every 4 m."""
    end = 4.0 * count
    segments = [[-2.0, 0.0, end, 0.0], [-2.0, 0.0, -2.0, 1.6], [-2.0, 1.6, 0.0, 1.6], [end, 0.0, end, 1.6]]
    for k in range(count):
        x = 4.0 * k
        segments += [[x, 1.6, x + 1.3, 1.6], [x + 2.3, 1.6, x + 4.0, 1.6]]
        segments += [[x + 0.2, 1.6, x + 0.2, 4.6], [x + 3.8, 1.6, x + 3.8, 4.6], [x + 0.2, 4.6, x + 3.8, 4.6]]
        segments += rectangle(x + 2.8, 3.6, x + 3.8, 4.2)
    return Room(np.array(segments), np.zeros((0, 3)))


def along(corners: Sequence[tuple[float, float]]) -> Iterator[Pose2]:
    """A pose every half metre, and one every half radian at the corners."""
    yaw = math.atan2(corners[1][1] - corners[0][1], corners[1][0] - corners[0][0])
    for (x0, y0), (x1, y1) in itertools.pairwise(corners):
        heading, length = math.atan2(y1 - y0, x1 - x0), math.hypot(x1 - x0, y1 - y0)
        turn = wrap_angle(heading - yaw)
        for k in range(round(abs(turn) / 0.5)):
            yield Pose2(x0, y0, yaw + turn * (k + 1) / round(abs(turn) / 0.5))
        yaw = heading
        for k in range(1, round(length / 0.5) + 1):
            share = k / round(length / 0.5)
            yield Pose2(x0 + share * (x1 - x0), y0 + share * (y1 - y0), heading)


def sweep_at(room: Room, pose: Pose2, number: int) -> Sweep:
    angles = np.linspace(-np.pi, np.pi, 240, endpoint=False)
    ranges = room.ranges(np.tile(pose.xy, (240, 1)), angles + pose.yaw_rad)
    ranges = ranges + np.random.default_rng(number).normal(0.0, 0.01, 240)
    ends = (np.minimum(ranges, 8.0)[:, None] * np.column_stack((np.cos(angles), np.sin(angles)))).astype(
        np.float32
    )
    return Sweep(float(number), np.zeros_like(ends), ends, ranges <= 8.0)


STEADY = np.array([0.01, 0.01, 0.004])


def drifting(
    room: Room, way: list[Pose2], slips: dict[int, tuple[float, float, float]], seed: int
) -> tuple[BackEnd, float]:
    """Keyframes along a way whose steps err a little, and at the slips by so many metres and radians.

    Returns:
        The back end, and the worst error while driving.
    """
    rng, end, worst = np.random.default_rng(seed), BackEnd(loop_closures=True), 0.0
    newest = end.begin(sweep_at(room, way[0], 0), way[0])
    for number in range(1, len(way)):
        error = rng.normal(0.0, STEADY) + np.array(slips.get(number, (0.0, 0.0, 0.0)))
        sigmas = STEADY + np.abs(slips.get(number, (0.0, 0.0, 0.0)))
        step = way[number - 1].between(way[number]).compose(Pose2(*error.tolist()))
        newest = end.extend(sweep_at(room, way[number], number), newest, step, np.diag(sigmas) ** 2)
        worst = max(worst, end.pose(newest).distance_to(way[number]))
    return end, worst
