"""Long ways through buildings, and what a robot of the years about 2000 would have logged on them."""

from __future__ import annotations

import bz2
import itertools
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
from explore_bt_drivers.world import World, fitting_cells
from explore_bt_planners import GridAstar
from explore_bt_planners.grid_astar import GridAstarOptions
from numpy.typing import NDArray

from explore_bt.types import Pose2, wrap_angle

__all__ = ["LONG_CORRIDORS", "LoggingRobot", "corridors_map", "drive", "tour", "write_log"]

Points = Sequence[tuple[float, float]]

_CELL_M = 0.05
_WIDTH_M = 2.4
_LONG_M, _DEEP_M, _MIDDLE_M = 110.0, 60.0, 48.0
LONG_CORRIDORS: Points = tuple(
    (x + 3.0, y + 3.0)
    for x, y in (
        (_MIDDLE_M - 20.0, 0.0),
        (_LONG_M, 0.0),
        (_LONG_M, _DEEP_M),
        (0.0, _DEEP_M),
        (0.0, 0.0),
        (_MIDDLE_M, 0.0),
        (_MIDDLE_M, _DEEP_M),
        (_LONG_M, _DEEP_M),
        (_LONG_M, 0.0),
        (_MIDDLE_M, 0.0),
        (_MIDDLE_M, _DEEP_M),
        (0.0, _DEEP_M),
    )
)
"""Middle lines of the corridors of ``corridors_map``: the outer ring first, 340 m, then back and forth."""
_STEP_S = 0.05
_ROBOT_M = 0.3
_SPEED_CHANGE, _TURN_CHANGE = 0.5 * _STEP_S, 1.0 * _STEP_S


@dataclass(frozen=True, slots=True)
class LoggingRobot:
    """What drives and measures.

    Attributes:
        speed_mps, turn_rate_rps: at most; 0.5 m/s² and 1 rad/s² on the way there.
        rate_hz: of the scans.
        beams: over 180°, both ends included where the number is odd.
        range_m: of the lidar; from there on it reports 81.91 m.
        noise_m: of a range.
        wheel_scale: the wheels claim so much more way than was driven, as a share.
        wheel_turn_degpm: they turn by so many degrees too much per metre; it wanders by as much in 50 m.
        jitter_s: standard deviation of a stamp.
        is_robotlaser: writes ROBOTLASER1 lines, else FLASER.
    """

    speed_mps: float = 0.5
    turn_rate_rps: float = 0.8
    rate_hz: float = 5.0
    beams: int = 180
    range_m: float = 80.0
    noise_m: float = 0.01
    wheel_scale: float = 0.03
    wheel_turn_degpm: float = 0.3
    jitter_s: float = 0.02
    is_robotlaser: bool = False

    @property
    def angles_rad(self) -> NDArray[np.float64]:
        """(beams,) float64: directions of the beams as a CARMEN log means them."""
        steps = self.beams - self.beams % 2
        return -0.5 * math.pi + np.arange(self.beams) * (math.pi / steps)


def corridors_map(folder: Path, seed: int = 0) -> Path:
    """Write a map of two rings of corridors, 110 × 60 m, as a map_server YAML; returns its path.

    The walls have door niches, pillars and rooms at odd places, but for two stretches of 15 m that are plain.
    """
    rng = np.random.default_rng(seed)
    shape = (int((_DEEP_M + 6.0) / _CELL_M), int((_LONG_M + 6.0) / _CELL_M))
    free = np.zeros(shape, np.uint8)
    half = 0.5 * _WIDTH_M

    def dig(x0: float, y0: float, x1: float, y1: float, value: int = 255) -> None:
        rows = slice(round((min(y0, y1) + 3.0) / _CELL_M), round((max(y0, y1) + 3.0) / _CELL_M))
        cols = slice(round((min(x0, x1) + 3.0) / _CELL_M), round((max(x0, x1) + 3.0) / _CELL_M))
        free[rows, cols] = value

    for y in (0.0, _DEEP_M):
        dig(-half, y - half, _LONG_M + half, y + half)
        for at in np.cumsum(rng.uniform(1.5, 6.0, 60)):
            if at > _LONG_M - 2.0 or 60.0 < at < 75.0:
                continue
            side, kind = rng.choice([-1.0, 1.0]), rng.random()
            if kind < 0.5:
                dig(at, y + side * half, at + 1.0, y + side * (half + rng.uniform(0.1, 0.3)))
            elif kind < 0.75:
                dig(at, y + side * half, at + rng.uniform(0.2, 0.5), y + side * (half - 0.2), 0)
            else:
                dig(
                    at, y + side * half, at + rng.uniform(0.9, 1.5), y + side * (half + rng.uniform(0.8, 1.6))
                )
    for x in (0.0, _MIDDLE_M, _LONG_M):
        dig(x - half, -half, x + half, _DEEP_M + half)
        for at in np.cumsum(rng.uniform(1.5, 6.0, 40)):
            if at > _DEEP_M - 2.0:
                break
            side = rng.choice([-1.0, 1.0])
            dig(x + side * half, at, x + side * (half + rng.uniform(0.1, 0.4)), at + rng.uniform(0.8, 1.2))
    cv2.imwrite(str(folder / "corridors.png"), np.flipud(np.where(free, 254, 0)).astype(np.uint8))
    path = folder / "corridors.yaml"
    path.write_text(
        f"image: corridors.png\nresolution: {_CELL_M}\norigin: [0.0, 0.0, 0.0]\n"
        "negate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n"
    )
    return path


def tour(world: World, places: int, seed: int) -> Points:
    """Random free places, the first third of them visited a second time at the end."""
    rng = np.random.default_rng(seed)
    cells = np.argwhere(_largest(fitting_cells(world, _ROBOT_M + 0.1)))
    chosen = [world.floor.center_of(*map(int, cells[k])) for k in rng.integers(len(cells), size=places)]
    return [*chosen, *chosen[: max(places // 3, 2)]]


def drive(world: World, places: Points, robot: LoggingRobot) -> NDArray[np.float64]:
    """The true way through all places: (N, 3) float64 x, y (m), yaw (rad), one every 50 ms."""
    planner = GridAstar(GridAstarOptions(margin=0.1))
    legs = []
    for (x0, y0), (x1, y1) in itertools.pairwise(places):
        path = planner.plan(world.floor, Pose2(x0, y0, 0.0), Pose2(x1, y1, 0.0), _ROBOT_M)
        legs.append(np.asarray(path.poses)[:, :2])
    way = np.concatenate(legs)
    apart = np.concatenate(([True], np.hypot(*np.diff(way, axis=0).T) > 1e-6))
    return np.array(list(_followed(way[apart], robot)))


def write_log(
    path: Path, world: World, way: NDArray[np.float64], robot: LoggingRobot, seed: int
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Write what the robot logs on its way, ``.clf.bz2``.

    Returns:
        (N,) float64 log stamps of the scans, and (N, 3) float64 true poses at them.
    """
    rng = np.random.default_rng(seed)
    every = round(1.0 / (robot.rate_hz * _STEP_S))
    picked = np.arange(0, len(way), every)
    wheels = _wheels(way[picked], robot, rng)
    stamps = np.round(1e9 + picked * _STEP_S + rng.normal(0.0, robot.jitter_s, len(picked)), 6)
    lines = []
    for stamp_s, pose, rolled in zip(stamps, way[picked], wheels, strict=True):
        ranges = world.cast(pose[0], pose[1], pose[2] + robot.angles_rad, robot.range_m)
        ranges = ranges + rng.normal(0.0, robot.noise_m, robot.beams)
        ranges[~(ranges < robot.range_m) | (rng.random(robot.beams) < 0.005)] = 81.91
        lines.append(_line(robot, stamp_s, np.maximum(ranges, 0.03), rolled))
    path.write_bytes(bz2.compress("".join(lines).encode(), 1))
    return stamps, way[picked]


def _line(
    robot: LoggingRobot, stamp_s: float, ranges: NDArray[np.float64], wheels: NDArray[np.float64]
) -> str:
    numbers = " ".join(f"{value:.2f}" for value in ranges)
    pose = " ".join(f"{value:.6f}" for value in wheels)
    end = f"{stamp_s:.6f} robot {stamp_s:.6f}\n"
    if not robot.is_robotlaser:
        return f"FLASER {robot.beams} {numbers} {pose} {pose} {end}"
    step = math.pi / (robot.beams - robot.beams % 2)
    head = f"0 {-0.5 * math.pi:.6f} {math.pi:.6f} {step:.6f} {robot.range_m:.2f} 0.01 0"
    return f"ROBOTLASER1 {head} {robot.beams} {numbers} 0 {pose} {pose} 0 0 0.3 0.3 10 {end}"


def _wheels(way: NDArray[np.float64], robot: LoggingRobot, rng: np.random.Generator) -> NDArray[np.float64]:
    """(N, 3): what the wheels make of the way; noise of 3 % a step on top of scale and turn."""
    bias, here = math.radians(robot.wheel_turn_degpm), Pose2.identity()
    wander, rolled = 0.0, [here.as_array()]
    for last, now in itertools.pairwise(way):
        step = Pose2(*last.tolist()).between(Pose2(*now.tolist()))
        length = math.hypot(step.x, step.y)
        wander += rng.normal(0.0, bias * math.sqrt(length / 50.0))
        noise = rng.normal(0.0, 0.03, 2)
        scale = 1.0 + robot.wheel_scale + noise[0]
        turn = step.yaw_rad * (1.0 + 0.5 * robot.wheel_scale + noise[1]) + (bias + wander) * length
        here = here.compose(Pose2(step.x * scale, step.y * scale, turn))
        rolled.append(here.as_array())
    return np.array(rolled)


def _followed(way: NDArray[np.float64], robot: LoggingRobot) -> Iterator[NDArray[np.float64]]:
    """A unicycle that heads for a point 0.4 m along, and turns on the spot at sharp corners."""
    x, y = way[0]
    yaw, at, speed, turn = math.atan2(*(way[min(4, len(way) - 1)] - way[0])[::-1]), 0, 0.0, 0.0
    while at < len(way) - 1 or math.hypot(*(way[-1] - (x, y))) > 0.1:
        while at < len(way) - 1 and math.hypot(*(way[at] - (x, y))) < 0.4:
            at += 1
        off = wrap_angle(math.atan2(way[at, 1] - y, way[at, 0] - x) - yaw)
        wanted = min(max(2.0 * off, -robot.turn_rate_rps), robot.turn_rate_rps)
        turn += min(max(wanted - turn, -_TURN_CHANGE), _TURN_CHANGE)
        wanted = robot.speed_mps * max(1.0 - abs(off) / 0.6, 0.0)
        speed += min(max(wanted - speed, -_SPEED_CHANGE), _SPEED_CHANGE)
        yaw += turn * _STEP_S
        x, y = x + math.cos(yaw) * speed * _STEP_S, y + math.sin(yaw) * speed * _STEP_S
        yield np.array([x, y, wrap_angle(yaw)])


def _largest(cells: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """The largest piece of connected cells."""
    _, labels, sizes, _ = cv2.connectedComponentsWithStats(cells.astype(np.uint8), connectivity=4)
    return np.asarray(labels == 1 + int(np.argmax(sizes[1:, cv2.CC_STAT_AREA])))
