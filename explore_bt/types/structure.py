"""What a map is made of, beyond its grid: voxels and a pose graph."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

__all__ = ["MapStructure", "PoseGraph2", "Voxels"]


@dataclass(frozen=True, slots=True, eq=False)
class Voxels:
    """A sparse volume in the ``map`` frame, z from the floor.

    Attributes:
        keys: (N, 3) int32, no two alike: voxel k spans [k, k + 1) times ``resolution_m`` along x, y, z.
        log_odds: (N,) float32: above 0 is occupied, below is seen empty.
        resolution_m: side of a voxel.
    """

    keys: NDArray[np.int32]
    log_odds: NDArray[np.float32]
    resolution_m: float

    @property
    def occupied_centres(self) -> NDArray[np.float32]:
        """(M, 3) float32, metres, ``map`` frame: centres of the occupied voxels."""
        return ((self.keys[self.log_odds > 0.0] + 0.5) * self.resolution_m).astype(np.float32)


@dataclass(frozen=True, slots=True, eq=False)
class PoseGraph2:
    """Keyframes and what was measured between them.

    Attributes:
        poses: (N, 3) float64: x, y (m), yaw (rad), ``map`` frame.
        ends: (M, 2) int64: the two keyframes of each edge.
        relatives: (M, 3) float64: pose of the second in the first, x, y (m), yaw (rad).
        information: (M, 3, 3) float64: inverse covariance of ``relatives``, axes of the second keyframe.
    """

    poses: NDArray[np.float64]
    ends: NDArray[np.int64]
    relatives: NDArray[np.float64]
    information: NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class MapStructure:
    """What SLAM can tell about the inside of its map; None where it has no such thing."""

    voxels: Voxels | None = None
    graph: PoseGraph2 | None = None
