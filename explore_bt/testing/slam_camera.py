"""An RGB-D camera for the scripted robot: vertical walls with procedural textures, depth that gets worse."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from explore_bt.testing.slam_room import Room, ScriptedRobot
from explore_bt.types import Measurement, Pose2, RgbdFrame

__all__ = ["PLAIN", "RoomCamera", "filmed"]

PLAIN = -1
"""The texture of a wall without any."""

_CELLS_M = (0.31, 0.13, 0.05)
_PLAIN_GREY = 150.0
_FLOOR_GREY, _CEILING_GREY = 90.0, 200.0
_CONTRAST = 180.0


@dataclass(slots=True)
class RoomCamera:
    """320 × 240 pixels, 70° wide, 0.5 m above the floor, looking ahead.

    Depth has a standard deviation of 2.5 mm at 1 m that grows with its square, and ends at 6 m.

    Attributes:
        room: its segments are walls of 2.5 m; its pillars are not seen.
        textures: (N,) int64, one for each segment: equal numbers look the same, ``PLAIN`` has no pattern.
    """

    room: Room
    textures: NDArray[np.int64]
    seed: int = 0
    width: int = 320
    height: int = 240
    wall_m: float = 2.5
    above_floor_m: float = 0.5
    ahead_m: float = 0.1
    range_m: float = 6.0
    depth_noise: float = 0.0025
    grey_noise: float = 3.0
    _rng: np.random.Generator = field(init=False)

    def __post_init__(self) -> None:
        self._rng = np.random.default_rng(self.seed)

    def frame(self, stamp_s: float, pose: Pose2) -> RgbdFrame:
        """What the camera sees with the robot at ``pose``."""
        f = 0.5 * self.width / math.tan(math.radians(35.0))
        cx, cy = 0.5 * (self.width - 1), 0.5 * (self.height - 1)
        right = (np.arange(self.width, dtype=np.float64) - cx) / f
        down = (np.arange(self.height) - cy)[:, None] / f
        eye = np.array(pose.compose(Pose2(self.ahead_m, 0.0, 0.0)).xy)
        depth, segment, along = self._columns(eye, pose.yaw_rad, right)
        above = self.above_floor_m - down * depth
        with np.errstate(divide="ignore"):
            flat = np.where(down > 0.0, self.above_floor_m, self.above_floor_m - self.wall_m) / down
        on_wall = (above >= 0.0) & (above <= self.wall_m)
        grey = np.where(down > 0.0, _FLOOR_GREY, _CEILING_GREY)
        grey = np.where(on_wall, self._greys(segment, along, above), grey)
        grey = grey + self._rng.normal(0.0, self.grey_noise, grey.shape)
        z = np.where(on_wall, depth, flat)
        z = z + self._rng.normal(0.0, 1.0, z.shape) * self.depth_noise * np.minimum(z, self.range_m) ** 2
        z = np.where(z <= self.range_m, z, np.nan)
        return RgbdFrame(
            stamp_s,
            np.clip(np.rint(grey), 0.0, 255.0).astype(np.uint8),
            z.astype(np.float32),
            f,
            f,
            cx,
            cy,
            _mounting(self.ahead_m, self.above_floor_m),
        )

    def _columns(
        self, eye: NDArray[np.float64], yaw_rad: float, right: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], NDArray[np.int64], NDArray[np.float64]]:
        """Per image column: depth to the nearest wall, which segment, and how far along it."""
        cos, sin = math.cos(yaw_rad), math.sin(yaw_rad)
        # a ray whose part along the optical axis is 1, so that its parameter is the depth
        rays = np.column_stack((cos + right * sin, sin - right * cos))[:, None, :]
        start = self.room.segments[:, :2]
        along = self.room.segments[:, 2:] - start
        gap = start - eye
        across = rays[..., 0] * along[:, 1] - rays[..., 1] * along[:, 0]
        with np.errstate(divide="ignore", invalid="ignore"):
            depth = (gap[:, 0] * along[:, 1] - gap[:, 1] * along[:, 0]) / across
            share = (gap[:, 0] * rays[..., 1] - gap[:, 1] * rays[..., 0]) / across
            met = (depth > 0.05) & (share >= 0.0) & (share <= 1.0)
        depth = np.where(met, depth, np.inf)
        nearest = np.argmin(depth, axis=1)
        columns = np.arange(right.shape[0])
        lengths = np.hypot(along[:, 0], along[:, 1])
        with np.errstate(invalid="ignore"):
            return depth[columns, nearest], nearest, share[columns, nearest] * lengths[nearest]

    def _greys(
        self, segment: NDArray[np.int64], along: NDArray[np.float64], above: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """Patches of three sizes, each of a grey that its place and the wall's texture decide."""
        texture = self.textures[segment]
        total = np.zeros(above.shape)
        with np.errstate(invalid="ignore"):
            for octave, cell_m in enumerate(_CELLS_M):
                i = np.nan_to_num(np.floor(along / cell_m), posinf=0.0, neginf=0.0).astype(np.int64)
                j = np.nan_to_num(np.floor(above / cell_m), posinf=0.0, neginf=0.0).astype(np.int64)
                total += _noise(i, j, texture * len(_CELLS_M) + octave) - 0.5
        pattern = 128.0 + _CONTRAST * total / len(_CELLS_M) * 1.5
        return np.where(texture == PLAIN, _PLAIN_GREY, pattern)


def filmed(
    robot: ScriptedRobot, camera: RoomCamera, measured: Iterable[Measurement], period_s: float = 0.2
) -> Iterator[Measurement]:
    """A drive's measurements with an image every ``period_s`` in between."""
    due_s = robot.time_s
    for measurement in measured:
        yield measurement
        if robot.time_s >= due_s:
            due_s = robot.time_s + period_s
            yield camera.frame(robot.time_s, robot.pose)


def _mounting(ahead_m: float, above_floor_m: float) -> NDArray[np.float64]:
    """(4, 4): optical axes (right, down, ahead) in ``base_link``."""
    pose = np.eye(4)
    pose[:3, :3] = [[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]]
    pose[:3, 3] = [ahead_m, 0.0, above_floor_m]
    return pose


def _noise(i: NDArray[np.int64], j: NDArray[np.int64], k: NDArray[np.int64]) -> NDArray[np.float64]:
    """A number in [0, 1) for each cell; the same for the same cell (an integer hash, after Wang 2007)."""
    x = (i * 73856093 ^ j * 19349663 ^ k * 83492791) & 0xFFFFFFFF
    x = ((x ^ (x >> 16)) * 0x45D9F3B) & 0xFFFFFFFF
    x = ((x ^ (x >> 16)) * 0x45D9F3B) & 0xFFFFFFFF
    return (x ^ (x >> 16)) / 2.0**32
