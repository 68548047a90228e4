"""A step between keyframes by lidar and IMU, and the same step by the camera."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from explore_bt.types import Pose2, wrap_angle
from explore_bt_slam.sight_match import SightMatch

__all__ = ["fuse_step"]

_CREDIBLE = 16.3  # χ² of three degrees of freedom, 99.9 %
_OPEN_M = 0.1
"""Standard deviation of a step in the direction that the lidar leaves open: there only the IMU speaks, and it
does not know of an accelerometer that suddenly feels what is not there."""


def fuse_step(
    relative: Pose2, covariance: NDArray[np.float64], seen: SightMatch, open_m: float = 0.0
) -> tuple[Pose2, NDArray[np.float64]] | None:
    """Both together, weighted by their information (Bar-Shalom et al. 2001); None if they contradict.

    Args:
        relative: ``T_last_new`` by lidar and IMU, with one direction left open.
        covariance: (3, 3) float64 of it over x, y (m²), yaw (rad²), axes of the new keyframe.
        seen: the same by the camera.
        open_m: standard deviation that the open direction has at least, if that is more than 10 cm.

    Returns:
        Step and covariance, as they came.
    """
    cos, sin = np.cos(relative.yaw_rad), np.sin(relative.yaw_rad)
    turn = np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]])
    variances, directions = np.linalg.eigh(turn @ covariance @ turn.T)
    variances[-1] = max(variances[-1], _OPEN_M**2, open_m**2)
    ours = (directions * variances) @ directions.T
    off = seen.relative.as_array() - relative.as_array()
    off[2] = wrap_angle(float(off[2]))
    if off @ np.linalg.solve(ours + seen.covariance, off) > _CREDIBLE:
        return None
    gain = ours @ np.linalg.inv(ours + seen.covariance)
    x, y, yaw_rad = (relative.as_array() + gain @ off).tolist()
    fused = (np.eye(3) - gain) @ ours
    fused = turn.T @ fused @ turn
    return Pose2(x, y, yaw_rad), 0.5 * (fused + fused.T)
