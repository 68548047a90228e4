"""Two sights laid onto each other: the motion between their keyframes from 3D–3D matches."""

from __future__ import annotations

import math
from dataclasses import dataclass

import cv2
import numpy as np
from numba import njit
from numpy.typing import NDArray

from explore_bt.types import Pose2
from explore_bt_slam.arrays import Bools, Floats
from explore_bt_slam.sight import Sight

__all__ = ["FEWEST", "SightMatch", "match_sights"]

_NEAR_BITS = 60
_MOST_PAIRS = 80
FEWEST = 15
"""So many features have to agree."""
_BASELINE_M = 0.4
_SLACK_M = 0.03
_COMMON = np.diag([0.015, 0.015, 0.005]) ** 2
"""What all matches of two images have in common: calibration, and the robot not being quite level."""


@dataclass(frozen=True, slots=True, eq=False)
class SightMatch:
    """How two keyframes lie to each other by what the camera saw.

    Attributes:
        relative: ``T_old_new``.
        covariance: (3, 3) float64 over x, y (m²), yaw (rad²), axes of the old keyframe.
        inliers: matches that agree.
    """

    relative: Pose2
    covariance: NDArray[np.float64]
    inliers: int


def match_sights(old: Sight, new: Sight) -> SightMatch | None:
    """The motion that lays most features of ``new`` onto like ones of ``old``; None if too few agree.

    The robot stands level, so a motion has three unknowns and two matches give it. With at most 80 matches
    every pair of them is tried: RANSAC without dice (Fischler and Bolles 1981). Heights must agree too.
    """
    if min(old.points.shape[0], new.points.shape[0]) < FEWEST:
        return None
    matches = cv2.BFMatcher(cv2.NORM_HAMMING, crossCheck=True).match(new.descriptors, old.descriptors)
    near = sorted(
        (match.distance, match.queryIdx, match.trainIdx) for match in matches if match.distance <= _NEAR_BITS
    )
    ours, theirs = np.array([each[1:] for each in near], dtype=np.int64).reshape(-1, 2).T
    a, b = old.points[theirs].astype(np.float64), new.points[ours].astype(np.float64)
    sigmas = np.hypot(old.sigmas_m[theirs], new.sigmas_m[ours]).astype(np.float64)
    level = np.flatnonzero(np.abs(a[:, 2] - b[:, 2]) <= 3.0 * sigmas + _SLACK_M)[:_MOST_PAIRS]
    a, b, sigmas = a[level, :2], b[level, :2], sigmas[level]
    agreeing = _largest_agreement(a, b, 3.0 * sigmas + _SLACK_M, _BASELINE_M)
    for _ in range(2):
        if np.count_nonzero(agreeing) < FEWEST:
            return None
        relative = _fit(a[agreeing], b[agreeing], sigmas[agreeing] ** -2.0)
        agreeing = np.linalg.norm(relative.apply(b) - a, axis=1) <= 3.0 * sigmas + _SLACK_M
    information = _information(relative, b[agreeing], sigmas[agreeing])
    if np.linalg.eigvalsh(information)[0] <= 1.0:
        return None
    return SightMatch(relative, np.linalg.inv(information) + _COMMON, int(np.count_nonzero(agreeing)))


def _fit(a: NDArray[np.float64], b: NDArray[np.float64], weights: NDArray[np.float64]) -> Pose2:
    """The weighted least-squares motion from (N, 2) ``b`` to ``a`` (Horn 1987, in the plane)."""
    share = weights / weights.sum()
    centre_a, centre_b = share @ a, share @ b
    p, q = b - centre_b, a - centre_a
    sine = float(share @ (p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0]))
    cosine = float(share @ (p * q).sum(axis=1))
    turn = Pose2(0.0, 0.0, math.atan2(sine, cosine))
    shift = centre_a - turn.apply(centre_b[None, :])[0]
    return Pose2(float(shift[0]), float(shift[1]), turn.yaw_rad)


def _information(relative: Pose2, b: NDArray[np.float64], sigmas: NDArray[np.float64]) -> NDArray[np.float64]:
    """(3, 3): what the matches say about x, y and yaw, old axes."""
    arms = Pose2(0.0, 0.0, relative.yaw_rad).apply(b)
    jacobians = np.zeros((b.shape[0], 2, 3))
    jacobians[:, 0, 0] = jacobians[:, 1, 1] = 1.0
    jacobians[:, 0, 2], jacobians[:, 1, 2] = -arms[:, 1], arms[:, 0]
    weighted = jacobians / sigmas[:, None, None] ** 2
    return np.asarray(np.einsum("nki,nkj->ij", jacobians, weighted))


@njit(cache=True)
def _largest_agreement(a: Floats, b: Floats, tolerance: Floats, baseline: float) -> Bools:
    """(N,) bool: the largest set of matches that one motion explains, over all pairs of matches."""
    count = a.shape[0]
    best = np.zeros(count, np.bool_)
    most = 0
    for i in range(count):
        for j in range(i + 1, count):
            ax, ay = a[j, 0] - a[i, 0], a[j, 1] - a[i, 1]
            bx, by = b[j, 0] - b[i, 0], b[j, 1] - b[i, 1]
            length = np.hypot(ax, ay)
            if length < baseline or abs(length - np.hypot(bx, by)) > tolerance[i] + tolerance[j]:
                continue
            yaw = np.arctan2(bx * ay - by * ax, bx * ax + by * ay)
            c, s = np.cos(yaw), np.sin(yaw)
            mx, my = 0.5 * (b[i, 0] + b[j, 0]), 0.5 * (b[i, 1] + b[j, 1])
            tx = 0.5 * (a[i, 0] + a[j, 0]) - c * mx + s * my
            ty = 0.5 * (a[i, 1] + a[j, 1]) - s * mx - c * my
            agree = 0
            for k in range(count):
                dx = c * b[k, 0] - s * b[k, 1] + tx - a[k, 0]
                dy = s * b[k, 0] + c * b[k, 1] + ty - a[k, 1]
                if dx * dx + dy * dy <= tolerance[k] * tolerance[k]:
                    agree += 1
            if agree > most:
                most = agree
                for k in range(count):
                    dx = c * b[k, 0] - s * b[k, 1] + tx - a[k, 0]
                    dy = s * b[k, 0] + c * b[k, 1] + ty - a[k, 1]
                    best[k] = dx * dx + dy * dy <= tolerance[k] * tolerance[k]
    return best
