"""One transform of ``/tf``."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from explore_bt.types import Pose2

__all__ = ["Transform"]


@dataclass(frozen=True, slots=True)
class Transform:
    """Where ``child`` is in ``parent``.

    Attributes:
        stamp_s: seconds of the ROS clock.
        shift: x, y, z in metres.
        turn: quaternion x, y, z, w, of length 1.
    """

    stamp_s: float
    parent: str
    child: str
    shift: tuple[float, float, float]
    turn: tuple[float, float, float, float]

    @classmethod
    def planar(cls, stamp_s: float, parent: str, child: str, pose: Pose2) -> Transform:
        """Of a pose in the plane."""
        half = 0.5 * pose.yaw_rad
        turn = (0.0, 0.0, float(np.sin(half)), float(np.cos(half)))
        return cls(stamp_s, parent, child, (pose.x, pose.y, 0.0), turn)

    @classmethod
    def of_matrix(cls, stamp_s: float, parent: str, child: str, T: NDArray[np.float64]) -> Transform:
        """Of (4, 4) float64 ``T_parent_child``."""
        from scipy.spatial.transform import Rotation

        x, y, z, w = Rotation.from_matrix(T[:3, :3]).as_quat().tolist()
        shift = (float(T[0, 3]), float(T[1, 3]), float(T[2, 3]))
        return cls(stamp_s, parent, child, shift, (x, y, z, w))

    def matrix(self) -> NDArray[np.float64]:
        """(4, 4) float64 ``T_parent_child``."""
        x, y, z, w = self.turn
        return np.array(
            [
                [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w), self.shift[0]],
                [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w), self.shift[1]],
                [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y), self.shift[2]],
                [0.0, 0.0, 0.0, 1.0],
            ]
        )
