"""What SLAM believes, and how much it trusts itself."""

from __future__ import annotations

import enum
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from explore_bt.types.pose import Pose2

__all__ = ["Estimate", "Health", "Trajectory"]


class Health(enum.StrEnum):
    """How far a pose estimate can be trusted."""

    OK = "ok"
    DEGRADED = "degraded"
    LOST = "lost"


def _no_covariance() -> NDArray[np.float64]:
    return np.zeros((3, 3))


@dataclass(frozen=True, slots=True, eq=False)
class Estimate:
    """The robot's pose as SLAM knows it.

    Attributes:
        stamp_s: time of the newest measurement it rests on, seconds.
        T_map_base: the pose.
        covariance: (3, 3) float64 over x, y (m²) and yaw (rad²), ``map`` frame.
        map_revision: revision of the grid that belongs to this pose.
        health, reason: trust, and in words why it is not ``ok``.
    """

    stamp_s: float
    T_map_base: Pose2
    covariance: NDArray[np.float64] = field(default_factory=_no_covariance)
    map_revision: int = 0
    health: Health = Health.OK
    reason: str = ""


@dataclass(frozen=True, slots=True, eq=False)
class Trajectory:
    """A path in time: (N,) float64 stamps in seconds, (N, 3) float64 x, y (m), yaw (rad), one frame."""

    stamps_s: NDArray[np.float64]
    poses: NDArray[np.float64]
