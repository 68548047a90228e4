"""Minimum-jerk smoothing under a floor of clearance."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray

from explore_bt_planners.polyline import length_of, resample, subdivide
from explore_bt_planners.sampling import STEP_CELLS, clearance_at

__all__ = ["ClearanceFloor", "smooth", "turn_points"]

_PASSES = 12
_SPLITS = 4
_SHARPEST_COSINE = math.cos(math.radians(40.0))  # per 0.1 m of path: 7/m, driven at a crawl
_EASY_M = 0.3  # slack from which on the reference holds the curve as loosely as it ever does
_LOOSEST, _TIGHTEST = 1e-3, 10.0  # weights of the reference against the squared third difference


@dataclass(frozen=True, slots=True)
class ClearanceFloor:
    """Which clearance a path has to keep.

    Attributes:
        threshold_m: everywhere, but while it leaves a tight start.
        start_m: until the threshold is first reached.
        leave_cells: within this arc length it has to be reached.
    """

    threshold_m: float
    start_m: float
    leave_cells: float


def smooth(
    polyline: NDArray[np.float64],
    clearance_m: NDArray[np.float32],
    floor: ClearanceFloor,
    spacing_cells: float,
    splits: int = _SPLITS,
) -> NDArray[np.float64]:
    """Points of a smooth path near the polyline, no chord of which falls below the floor.

    Minimises the squared third differences plus weighted squared distances to the polyline: one banded
    solve a pass; the samples of a curve with continuous curvature. Where a chord falls short, the reference
    moves uphill and its weight is raised. What cannot be mended in a few passes, or bends so hard that the
    robot would all but stop, is cut there in two, at a corner of the polyline: the robot turns in place.
    In the end the polyline itself is good enough, cut into short pieces.

    Args:
        polyline: (N, 2) float64 column, row as real numbers of cells; itself above the floor.
        clearance_m: (rows, cols) float32.
        floor: what to keep.
        spacing_cells: distance between the points of the result, about.
        splits: how often what remains may still be cut in two.

    Returns:
        (M, 2) float64; ends unchanged.
    """
    reference = resample(polyline, spacing_cells)
    args = (floor.threshold_m, floor.start_m, floor.leave_cells)
    points, worst = _relax(reference, clearance_m, *args)
    if worst < 0:
        return points
    if splits == 0 or len(polyline) < 3:
        return subdivide(polyline, spacing_cells)
    corner = 1 + int(np.hypot(*(polyline[1:-1] - reference[worst]).T).argmin())
    before = smooth(polyline[: corner + 1], clearance_m, floor, spacing_cells, splits - 1)
    leave_cells = max(floor.leave_cells - length_of(polyline[: corner + 1]), 0.0)
    rest = ClearanceFloor(floor.threshold_m, floor.start_m if leave_cells else floor.threshold_m, leave_cells)
    after = smooth(polyline[corner:], clearance_m, rest, spacing_cells, splits - 1)
    return np.concatenate((before, after[1:]))


def turn_points(points: NDArray[np.float64]) -> NDArray[np.int64]:
    """Indices of the points of a smoothed path at which the robot turns in place.

    Args:
        points: (N, 2) float64, N >= 2.
    """
    steps = np.diff(points, axis=0)
    steps /= np.maximum(np.hypot(*steps.T), 1e-12)[:, None]
    cosines = np.einsum("ij,ij->i", steps[:-1], steps[1:])
    return np.asarray(1 + np.flatnonzero(cosines < _SHARPEST_COSINE), dtype=np.int64)


@njit(cache=True)
def _relax(reference, clearance, threshold, start_floor, leave):  # type: ignore[no-untyped-def]  # numba kernel
    count = len(reference)
    anchor = reference.copy()
    weight = np.empty(count)
    for i in range(count):
        slack = max(clearance_at(clearance, anchor[i, 0], anchor[i, 1]) - threshold, 0.01)
        weight[i] = min(_TIGHTEST, _LOOSEST * max(1.0, (_EASY_M / slack) ** 2))
    short = np.zeros(count, dtype=np.bool_)
    points = anchor
    for _ in range(_PASSES):
        points = _solve(anchor, weight)
        if not _find_short(points, clearance, threshold, start_floor, leave, short):
            return points, _sharpest_bend(points)
        _hold_back(anchor, weight, short, clearance)
    return points, np.flatnonzero(short)[0]


@njit(cache=True)
def _sharpest_bend(points):  # type: ignore[no-untyped-def]  # numba kernel
    """Index of the sharpest bend that is sharper than a robot drives, -1 if there is none."""
    worst, least = -1, _SHARPEST_COSINE
    for i in range(1, len(points) - 1):
        du, dv = points[i] - points[i - 1]
        eu, ev = points[i + 1] - points[i]
        cosine = (du * eu + dv * ev) / max(math.hypot(du, dv) * math.hypot(eu, ev), 1e-12)
        if cosine < least:
            worst, least = i, cosine
    return worst


@njit(cache=True)
def _hold_back(anchor, weight, short, clearance):  # type: ignore[no-untyped-def]  # numba kernel
    """Move the reference uphill where the curve fell short, and pull harder around there."""
    count = len(anchor)
    for i in range(1, count - 1):
        if not short[i]:
            continue
        u, v = anchor[i]
        du = clearance_at(clearance, u + 0.5, v) - clearance_at(clearance, u - 0.5, v)
        dv = clearance_at(clearance, u, v + 0.5) - clearance_at(clearance, u, v - 0.5)
        norm = math.hypot(du, dv)
        if norm > 0.0:
            to_u, to_v = u + 0.4 * du / norm, v + 0.4 * dv / norm
            if clearance_at(clearance, to_u, to_v) > clearance_at(clearance, u, v):
                anchor[i, 0], anchor[i, 1] = to_u, to_v
        for k in range(max(0, i - 2), min(count, i + 3)):
            weight[k] = min(weight[k] * (3.0 if k == i else 1.4), 1e4)


@njit(cache=True)
def _find_short(points, clearance, threshold, start_floor, leave, short):  # type: ignore[no-untyped-def]  # numba kernel
    """Mark both ends of every chord with a place below the floor; returns whether there is one."""
    short[:] = False
    found = False
    left = clearance_at(clearance, points[0, 0], points[0, 1]) >= threshold
    along = 0.0
    for i in range(len(points) - 1):
        u0, v0 = points[i]
        u1, v1 = points[i + 1]
        length = math.hypot(u1 - u0, v1 - v0)
        steps = max(1, math.ceil(length / STEP_CELLS))
        for k in range(steps + 1):
            t = k / steps
            here = clearance_at(clearance, u0 + t * (u1 - u0), v0 + t * (v1 - v0))
            left = left or here >= threshold
            needed = threshold if left or along + t * length > leave else start_floor
            if here < needed:
                short[i] = short[i + 1] = found = True
                break
        along += length
    return found


@njit(cache=True)
def _solve(anchor, weight):  # type: ignore[no-untyped-def]  # numba kernel
    """Minimise ``|D3 p|² + sum w |p - anchor|²`` with both ends fixed, by a banded L D Lᵀ."""
    count = len(anchor)
    if count < 5:
        return anchor.copy()
    band = np.zeros((count, 4))  # band[i, k] = A[i, i - k]
    stencil = (-1.0, 3.0, -3.0, 1.0)
    for i in range(count - 3):
        for a in range(4):
            for b in range(a + 1):
                band[i + a, a - b] += stencil[a] * stencil[b]
    result = np.empty((count, 2))
    for i in range(count):
        w = 1e9 if i in (0, count - 1) else weight[i]
        band[i, 0] += w
        result[i, 0], result[i, 1] = w * anchor[i, 0], w * anchor[i, 1]
    for i in range(count):
        for k in range(min(i, 3), 0, -1):
            j = i - k
            for m in range(k + 1, min(i, 3) + 1):
                if m - k <= 3:
                    band[i, k] -= band[i, m] * band[j, m - k] * band[i - m, 0]
            band[i, k] /= band[j, 0]
        for k in range(1, min(i, 3) + 1):
            band[i, 0] -= band[i, k] * band[i, k] * band[i - k, 0]
            result[i] -= band[i, k] * result[i - k]
    for i in range(count):
        result[i] /= band[i, 0]
    for i in range(count - 1, -1, -1):
        for k in range(1, min(i, 3) + 1):
            result[i - k] -= band[i, k] * result[i]
    result[0], result[count - 1] = anchor[0], anchor[count - 1]
    return result
