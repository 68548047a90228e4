"""A small room with exact ranges, and a scripted drive through it: what the SLAM contract is run on."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from explore_bt.interfaces import GroundTruth
from explore_bt.types import (
    FREE,
    UNKNOWN,
    Imu,
    Measurement,
    OccupancyGrid,
    Pose2,
    Scan2D,
    WheelOdometry,
    wrap_angle,
)

__all__ = ["Room", "RoomTruth", "ScriptedRobot"]

_STEP_S = 0.01
_GRAVITY_MPS2 = 9.81


@dataclass(frozen=True, slots=True)
class Room:
    """Walls as segments, pillars as circles.

    Attributes:
        segments: (N, 4) float64: x0, y0, x1, y1, metres.
        pillars: (M, 3) float64: x, y, radius, metres.
    """

    segments: NDArray[np.float64]
    pillars: NDArray[np.float64]

    @staticmethod
    def furnished() -> Room:
        """6 × 4 m about the origin, with three pillars of different sizes and a cupboard."""
        walls = _box(-3.0, -2.0, 3.0, 2.0)
        cupboard = _box(2.2, 1.2, 3.0, 2.0)
        pillars = np.array([[-1.5, 1.2, 0.15], [1.6, -1.2, 0.2], [-2.2, -1.3, 0.1]])
        return Room(np.vstack((walls, cupboard)), pillars)

    def ranges(self, origins: NDArray[np.float64], angles: NDArray[np.float64]) -> NDArray[np.float64]:
        """(N,) float64 exact distances along rays; +inf where nothing is met.

        Args:
            origins: (N, 2) x, y, metres.
            angles: (N,) radians, counter-clockwise from x.
        """
        rays = np.column_stack((np.cos(angles), np.sin(angles)))
        best = np.full(angles.shape[0], np.inf)
        for x0, y0, x1, y1 in self.segments:
            along = np.array([x1 - x0, y1 - y0])
            across = rays[:, 0] * along[1] - rays[:, 1] * along[0]
            gap = np.array([x0, y0]) - origins
            with np.errstate(divide="ignore", invalid="ignore"):
                t = (gap[:, 0] * along[1] - gap[:, 1] * along[0]) / across
                u = (gap[:, 0] * rays[:, 1] - gap[:, 1] * rays[:, 0]) / across
            best = np.where((t > 0.0) & (u >= 0.0) & (u <= 1.0) & (t < best), t, best)
        for x, y, radius in self.pillars:
            gap = np.array([x, y]) - origins
            middle = np.sum(gap * rays, axis=1)
            inside = radius**2 - (np.sum(gap * gap, axis=1) - middle**2)
            t = middle - np.sqrt(np.maximum(inside, 0.0))
            best = np.where((inside > 0.0) & (t > 0.0) & (t < best), t, best)
        return best

    def distance(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """(N,) float64: how far (N, 2) points lie from the nearest surface, metres."""
        best = np.full(points.shape[0], np.inf)
        for x0, y0, x1, y1 in self.segments:
            start, along = np.array([x0, y0]), np.array([x1 - x0, y1 - y0])
            share = np.clip((points - start) @ along / (along @ along), 0.0, 1.0)
            best = np.minimum(best, np.linalg.norm(points - start - share[:, None] * along, axis=1))
        for x, y, radius in self.pillars:
            best = np.minimum(best, np.abs(np.linalg.norm(points - [x, y], axis=1) - radius))
        return best


class RoomTruth(GroundTruth):
    """The truth about a ``ScriptedRobot``."""

    def __init__(self, robot: ScriptedRobot) -> None:
        self._robot = robot

    def pose(self) -> Pose2:
        """Where the robot is now."""
        return self._robot.pose

    def contacts(self) -> int:
        """The script touches nothing."""
        return 0

    def clearance_m(self) -> float:
        """Distance from the robot's centre to the nearest surface."""
        return float(self._robot.room.distance(np.array([self._robot.pose.xy]))[0])

    def observable_floor(self) -> OccupancyGrid:
        """Everything inside the walls, at 5 cm."""
        low = self._robot.room.segments.reshape(-1, 2).min(axis=0)
        high = self._robot.room.segments.reshape(-1, 2).max(axis=0)
        shape = np.ceil((high - low) / 0.05).astype(int)[::-1]
        grid = OccupancyGrid(np.full(shape, UNKNOWN, np.int8), 0.05, (float(low[0]), float(low[1])))
        centres = grid.centers_of(np.argwhere(grid.unknown))
        clear = self._robot.room.distance(centres).reshape(grid.shape) > 0.05
        return OccupancyGrid(np.where(clear, FREE, UNKNOWN).astype(np.int8), 0.05, grid.origin_xy)


@dataclass(slots=True)
class ScriptedRobot:
    """A unicycle that follows a script exactly and measures with little noise.

    IMU at 100 Hz, a 360-beam lidar at 10 Hz whose beams are taken one after another while the robot
    moves, wheel odometry at 20 Hz that slips by 3 %.

    Attributes:
        pose: true pose now, ``map`` frame.
        time_s: now.
    """

    room: Room
    pose: Pose2
    seed: int = 0
    range_noise_m: float = 0.01
    gyro_bias_rps: float = 0.01
    range_max_m: float = 5.0
    beams: int = 360
    time_s: float = 0.0
    _speed_mps: float = 0.0
    _odometry: Pose2 = field(default_factory=Pose2.identity)
    _poses: list[tuple[float, Pose2]] = field(default_factory=list)
    _rng: np.random.Generator = field(init=False)

    def __post_init__(self) -> None:
        self._rng = np.random.default_rng(self.seed)
        self._poses.append((self.time_s, self.pose))

    @property
    def history(self) -> Sequence[tuple[float, Pose2]]:
        """Times and true poses, every 10 ms."""
        return self._poses

    def pose_at(self, time_s: float) -> Pose2:
        """The true pose at a time on the 10 ms raster."""
        return self._poses[round((time_s - self._poses[0][0]) / _STEP_S)][1]

    def drive(self, speed_mps: float, turn_rate_rps: float, duration_s: float) -> Iterator[Measurement]:
        """Drive at constant twist; what is measured comes out as it happens, so that ``pose`` fits it."""
        for _ in range(round(duration_s / _STEP_S)):
            yield from self._step(speed_mps, turn_rate_rps)

    def _step(self, speed_mps: float, turn_rate_rps: float) -> list[Measurement]:
        acceleration = (speed_mps - self._speed_mps) / _STEP_S
        self._speed_mps = speed_mps
        middle = self.pose.yaw_rad + 0.5 * turn_rate_rps * _STEP_S
        step = Pose2(speed_mps * _STEP_S, 0.0, turn_rate_rps * _STEP_S)
        self.pose = Pose2(
            self.pose.x + math.cos(middle) * step.x,
            self.pose.y + math.sin(middle) * step.x,
            wrap_angle(self.pose.yaw_rad + step.yaw_rad),
        )
        self._odometry = self._odometry.compose(Pose2(1.03 * step.x, 0.0, 0.97 * step.yaw_rad))
        self.time_s = round(self.time_s + _STEP_S, 6)
        self._poses.append((self.time_s, self.pose))
        tick = round(self.time_s / _STEP_S)
        measured: list[Measurement] = [self._imu(acceleration, speed_mps * turn_rate_rps, turn_rate_rps)]
        if tick % 5 == 0:
            measured.append(WheelOdometry(self.time_s, self._odometry))
        if tick % 10 == 0:
            measured.append(self._scan())
        return measured

    def _imu(self, along_mps2: float, across_mps2: float, turn_rate_rps: float) -> Imu:
        noise = self._rng.normal(0.0, [0.002, 0.05, 0.05])
        return Imu(
            self.time_s,
            (0.0, 0.0, turn_rate_rps + self.gyro_bias_rps + float(noise[0])),
            (along_mps2 + float(noise[1]), across_mps2 + float(noise[2]), _GRAVITY_MPS2),
        )

    def _scan(self) -> Scan2D:
        times = np.linspace(-0.1, 0.0, self.beams + 1)[1:]
        angles = np.linspace(-math.pi, math.pi, self.beams, endpoint=False)
        recent = self._poses[-11:]
        stamps = np.array([stamp_s for stamp_s, _ in recent]) - self.time_s
        track = np.array([[pose.x, pose.y, pose.yaw_rad] for _, pose in recent])
        track[:, 2] = np.unwrap(track[:, 2])
        x, y, yaw = (np.interp(times, stamps, track[:, k]) for k in range(3))
        ranges = self.room.ranges(np.column_stack((x, y)), yaw + angles)
        ranges += self._rng.normal(0.0, self.range_noise_m, self.beams)
        ranges = np.where(ranges > self.range_max_m, np.inf, ranges)
        ranges[self._rng.random(self.beams) < 0.01] = np.nan
        return Scan2D(self.time_s, angles, ranges.astype(np.float32), times, 0.05, self.range_max_m)


def _box(x0: float, y0: float, x1: float, y1: float) -> NDArray[np.float64]:
    """(4, 4): the sides of a rectangle as segments."""
    corners = np.array([[x0, y0], [x1, y0], [x1, y1], [x0, y1]])
    return np.hstack((corners, np.roll(corners, -1, axis=0)))
