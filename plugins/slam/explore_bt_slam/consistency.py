"""Which closures can all be true at once (Mangelson et al. 2018, pairwise consistency)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from explore_bt.types import Pose2
from explore_bt_slam.pose_graph import Edge

__all__ = ["agree", "between", "largest_consistent"]

_COMMON = np.diag([0.05, 0.05, 0.02]) ** 2
_OLD_SHARE = 0.03
_GATE = 16.3  # χ² of three degrees of freedom, 99.9 %


def agree(
    one: Edge,
    other: Edge,
    poses: NDArray[np.float64],
    covariances: NDArray[np.float64],
    old_poses: NDArray[np.float64] | None = None,
) -> bool:
    """Whether two closures say the same about the drift.

    Around the loop a → b → b' → a' → a the known motions and the two closures must cancel.

    Args:
        one: ``b`` recent, ``a`` old.
        other: the same.
        poses: (N, 3) float64 keyframe poses.
        covariances: (N, 3, 3) float64 relative to the newest keyframe, see ``relative_covariances``.
        old_poses: (M, 3) float64, where the old keyframes are another robot's.
    """
    old = between(poses if old_poses is None else old_poses, other.a, one.a)
    loop = (
        one.relative.compose(between(poses, one.b, other.b)).compose(other.relative.inverse()).compose(old)
    ).as_array()
    apart = _OLD_SHARE * float(np.hypot(old.x, old.y))
    spread = covariances[other.b] + covariances[one.b] + one.covariance + other.covariance + _COMMON
    spread = spread + np.diag([apart, apart, 0.3 * _OLD_SHARE]) ** 2
    return float(loop @ np.linalg.solve(spread, loop)) <= _GATE


def largest_consistent(
    edges: Sequence[Edge],
    poses: NDArray[np.float64],
    covariances: NDArray[np.float64],
    old_poses: NDArray[np.float64] | None = None,
) -> list[Edge]:
    """The last edge and as many others as agree with it and with one another, found greedily.

    Args:
        edges: at least one.
        poses: see ``agree``.
        covariances: see ``agree``.
        old_poses: see ``agree``.
    """
    chosen = [edges[-1]]
    for edge in reversed(edges[:-1]):
        if all(agree(edge, other, poses, covariances, old_poses) for other in chosen):
            chosen.append(edge)
    return chosen[::-1]


def between(poses: NDArray[np.float64], a: int, b: int) -> Pose2:
    """Pose of keyframe ``b`` in keyframe ``a``, by (N, 3) poses in the ``map`` frame."""
    return Pose2(*poses[a].tolist()).between(Pose2(*poses[b].tolist()))
