"""How the body stands: read off its quaternion."""

from __future__ import annotations

import math
from collections.abc import Sequence

from explore_bt.types import Pose2

__all__ = ["pitch_of", "planar_pose", "roll_of", "upright"]


def pitch_of(w: float, x: float, y: float, z: float) -> float:
    """Nose down is positive, radians (REP-103)."""
    return math.asin(min(max(2.0 * (w * y - x * z), -1.0), 1.0))


def roll_of(w: float, x: float, y: float, z: float) -> float:
    """Right side down is positive, radians."""
    return math.atan2(2.0 * (w * x + y * z), 1.0 - 2.0 * (x * x + y * y))


def planar_pose(position: Sequence[float], quaternion: Sequence[float]) -> Pose2:
    """Where ``base_link`` is seen from above; the heading is square to the axle, whatever the pitch."""
    w, x, y, z = quaternion
    # the body's y axis: (2 (xy - wz), 1 - 2 (x² + z²))
    yaw = math.atan2(-2.0 * (x * y - w * z), 1.0 - 2.0 * (x * x + z * z))
    return Pose2(position[0], position[1], yaw)


def upright(yaw_rad: float) -> tuple[float, float, float, float]:
    """The quaternion, w x y z, of a body that stands and faces that way."""
    return (math.cos(0.5 * yaw_rad), 0.0, 0.0, math.sin(0.5 * yaw_rad))
