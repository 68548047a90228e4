"""Trajectory error against the truth."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from explore_bt.exploration.arguments import ArgumentError
from explore_bt.types import Pose2, Trajectory

__all__ = ["align_se2", "ate_rmse_m"]


def align_se2(source: NDArray[np.floating], target: NDArray[np.floating]) -> Pose2:
    """The rigid motion that takes points onto their partners with the least sum of squares.

    Umeyama, 1991, in the plane and without scale, where the rotation has a closed form.

    Args:
        source: (N, 2) metres, N ≥ 1.
        target: (N, 2) metres, their partners row by row.

    Returns:
        T_target_source. Where the points fix no rotation (all in one place) it is zero.
    """
    source_mean, target_mean = source.mean(axis=0), target.mean(axis=0)
    a, b = source - source_mean, target - target_mean
    yaw_rad = math.atan2(float((a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]).sum()), float((a * b).sum()))
    rotated = Pose2(0.0, 0.0, yaw_rad).apply(source_mean[None])[0]
    shift = target_mean - rotated
    return Pose2(float(shift[0]), float(shift[1]), yaw_rad)


def ate_rmse_m(estimate: Trajectory, truth: Trajectory, *, align: bool = True) -> float:
    """Absolute trajectory error: root mean square of the position error, metres.

    The truth is interpolated linearly at the estimate's stamps; stamps outside the truth's time are left
    out.

    Args:
        estimate: what SLAM believed.
        truth: what was, stamps not falling.
        align: whether to move the estimate rigidly onto the truth first, as is customary; without it
            both must be in one frame.

    Raises:
        ArgumentError: if no stamp of the estimate lies within the truth's time.
    """
    stamps = estimate.stamps_s
    first, last = (truth.stamps_s[0], truth.stamps_s[-1]) if truth.stamps_s.size else (math.inf, -math.inf)
    common = (stamps >= first) & (stamps <= last)
    if not common.any():
        raise ArgumentError(
            f"trajectory error: none of {stamps.size} estimated poses lies within the truth's time, "
            "expected at least one; give both trajectories of one run, on one clock"
        )
    positions = np.asarray(estimate.poses[common, :2], dtype=np.float64)
    actual = np.column_stack(
        [np.interp(stamps[common], truth.stamps_s, truth.poses[:, axis]) for axis in (0, 1)]
    )
    moved = align_se2(positions, actual).apply(positions) if align else positions
    return math.sqrt(float(((moved - actual) ** 2).sum(axis=1).mean()))
