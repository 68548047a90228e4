"""Keyframes: the scans that stay."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from explore_bt.types import Pose2
from explore_bt_slam.walls import filled_walls

__all__ = ["Keyframe", "KeyframeRule"]


@dataclass(frozen=True, slots=True, eq=False)
class Keyframe:
    """A scan kept for matching; its pose is the graph's business.

    Attributes:
        points, normals: (N, 2) float64, metres, base frame; normals (0, 0) where there is no line.
        driven_m: length of the way to here since the start.
        map_points, map_normals: (M, 2) float64: the same and the walls in between, see ``filled_walls``;
            other scans are laid onto these.
    """

    stamp_s: float
    points: NDArray[np.float64]
    normals: NDArray[np.float64]
    driven_m: float
    map_points: NDArray[np.float64] = field(init=False)
    map_normals: NDArray[np.float64] = field(init=False)

    def __post_init__(self) -> None:
        between, normals = filled_walls(self.points)
        object.__setattr__(self, "map_points", np.concatenate((self.points, between)))
        object.__setattr__(self, "map_normals", np.concatenate((self.normals, normals)))

    def within(self, reach_m: float) -> Keyframe:
        """The same without points farther off."""
        near = np.hypot(self.points[:, 0], self.points[:, 1]) <= reach_m
        return Keyframe(self.stamp_s, self.points[near], self.normals[near], self.driven_m)

    @property
    def reach_m(self) -> float:
        """No point lies farther off."""
        return float(np.hypot(self.points[:, 0], self.points[:, 1]).max(initial=0.0))


@dataclass(frozen=True, slots=True)
class KeyframeRule:
    """When a scan becomes a keyframe."""

    distance_m: float
    angle_rad: float
    overlap: float = 0.6

    def wants(self, since_keyframe: Pose2, overlap: float) -> bool:
        """Driven or turned far enough, or little of the scan is in the map yet."""
        far = float(np.hypot(since_keyframe.x, since_keyframe.y)) >= self.distance_m
        turned = abs(since_keyframe.yaw_rad) >= self.angle_rad
        moved = far or turned or float(np.hypot(since_keyframe.x, since_keyframe.y)) >= 0.1
        return far or turned or (moved and overlap < self.overlap)
