"""What speaks against two maps lying as some closures say: walls that the other robot looked through."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from explore_bt.types import Pose2
from explore_bt_slam.contradiction import seen_through
from explore_bt_slam.keyframes import Keyframe
from explore_bt_slam.local_map import gather_points, stretch_about

__all__ = ["contradiction", "is_contradicted"]

_MOST = 0.07
"""Mean share of seen-through walls: up to 0.04 where maps fit, 0.1 and more where rooms look alike."""
_BODY_M = 0.6
"""What was seen so near to where the other robot was is that robot."""
_NEAR_M = 2.5
_HALF_M = 1.5
_MOST_PAIRS = 24
_LEAST_PAIRS = 6


def is_contradicted(share: float | None) -> bool:
    """Whether so much of the walls seen through is more than doors and chairs that have moved."""
    return share is not None and share > _MOST


def contradiction(
    keyframes: Sequence[Keyframe],
    poses: NDArray[np.float64],
    others: Sequence[Keyframe],
    other_poses: NDArray[np.float64],
    moved: Callable[[int], Pose2],
    since: int = 0,
) -> float | None:
    """How much of the one's walls the other looks through, and the other way round; the worse mean, [0, 1].

    Every wall of the one that is in view of the other is asked about, also what the closures did not need.

    Args:
        keyframes: one's own.
        poses: (N, 3) float64, theirs, ``map`` frame.
        others: the mate's.
        other_poses: (M, 3) float64, theirs, in its own ``map`` frame.
        moved: where one of the mate's keyframes would lie in one's own ``map`` frame.
        since: only one's own keyframes from this one on are asked.

    Returns:
        None if they have hardly been near the same places yet.
    """
    there = np.array([moved(k).xy for k in range(len(others))])
    apart_m = np.hypot(*(poses[:, None, :2] - there[None]).transpose(2, 0, 1))
    nearest = apart_m.argmin(axis=1)
    pairs = [(i, int(k)) for i, k in enumerate(nearest) if i >= since and apart_m[i, k] <= _NEAR_M]
    if len(pairs) < _LEAST_PAIRS:
        return None
    chosen = pairs[:: max(len(pairs) // _MOST_PAIRS, 1)]
    ways = (cKDTree(poses[:, :2]), cKDTree(there))
    both = [_of_views(keyframes, poses, i, others, other_poses, k, moved(k), ways) for i, k in chosen]
    return float(np.mean(both, axis=0).max())


def _of_views(
    keyframes: Sequence[Keyframe],
    poses: NDArray[np.float64],
    own: int,
    others: Sequence[Keyframe],
    other_poses: NDArray[np.float64],
    other: int,
    there: Pose2,
    ways: tuple[cKDTree, cKDTree],
) -> tuple[float, float]:
    """Of one view each: share of the other's walls seen through, share of one's own; but for bodies.

    ``ways`` are the places of all keyframes, one's own and the other's, as ``there`` in one's own frame.
    """
    here = Pose2(*poses[own].tolist())
    T_ours_theirs = there.compose(Pose2(*other_poses[other].tolist()).inverse())
    theirs = _without(T_ours_theirs.apply(_walls(others, other_poses, other)), ways[0])
    ours = _without(_walls(keyframes, poses, own), ways[1])
    return (
        seen_through(theirs, keyframes[own].points, here),
        seen_through(ours, others[other].points, there),
    )


def _without(walls: NDArray[np.float64], way: cKDTree) -> NDArray[np.float64]:
    """The walls but what lies where somebody has driven."""
    distance_m, _ = way.query(walls, distance_upper_bound=_BODY_M)
    return walls[np.isinf(distance_m)]


def _walls(keyframes: Sequence[Keyframe], poses: NDArray[np.float64], about: int) -> NDArray[np.float64]:
    return gather_points(keyframes, poses, stretch_about(keyframes, about, _HALF_M))
