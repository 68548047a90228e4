"""What speaks against a match: walls of the map that the scan looks right through."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from explore_bt.types import Pose2

__all__ = ["seen_through"]

_BINS = 180
_DEPTH_M = 0.5


def seen_through(
    mapped: NDArray[np.float64], scan: NDArray[np.float64], pose: Pose2, reach_m: float = 8.0
) -> float:
    """Share of the mapped points in view that lie clearly in front of what the scan sees there.

    Args:
        mapped: (N, 2) float64, metres, ``map`` frame.
        scan: (M, 2) float64, returns in the base frame.
        pose: ``T_map_base`` to be judged.
        reach_m: mapped points farther off are not asked about.

    Returns:
        [0, 1]; 0 if no mapped point is in view.
    """
    nearest = np.full(_BINS, np.inf)
    np.minimum.at(nearest, _bins(scan), np.hypot(scan[:, 0], scan[:, 1]))
    # a beam is only trusted where its neighbours see as far: no quarrel about the edges of things
    around = np.minimum(nearest, np.minimum(np.roll(nearest, 1), np.roll(nearest, -1)))
    known = np.isfinite(nearest) & np.isfinite(np.roll(nearest, 1)) & np.isfinite(np.roll(nearest, -1))
    seen = pose.inverse().apply(mapped)
    distance, bins = np.hypot(seen[:, 0], seen[:, 1]), _bins(seen)
    asked = known[bins] & (distance <= reach_m)
    in_view = asked & (distance <= around[bins] + _DEPTH_M)
    if not in_view.any():
        return 0.0
    return float(np.count_nonzero(asked & (distance < around[bins] - _DEPTH_M)) / np.count_nonzero(in_view))


def _bins(points: NDArray[np.float64]) -> NDArray[np.int64]:
    turn = np.arctan2(points[:, 1], points[:, 0]) / (2.0 * np.pi)
    return np.asarray(np.floor(turn * _BINS).astype(np.int64) % _BINS)
