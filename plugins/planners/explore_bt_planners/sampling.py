"""Clearance of points and segments between cell centres, on the safe side.

Points are (column, row) as real numbers of cells: the centre of cell (row, col) is (col + 0.5, row + 0.5).
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

__all__ = ["STEP_CELLS", "clearance_at", "clearances_at", "segment_is_clear"]

STEP_CELLS = 0.125
"""Distance between samples along a segment, cells."""
_SPARE_CELLS = 2.25


@njit(cache=True)
def clearance_at(clearance, u, v):  # type: ignore[no-untyped-def]  # numba kernel
    """Clearance of a point, metres: the lower of its cell's value and of the bilinear interpolation.

    The interpolation alone is above the exact distance D by at most h²/8D (a cell of size h), since a
    distance to one obstacle is convex; the cell's value alone by up to 0.7 h.
    """
    rows, cols = clearance.shape
    row, col = math.floor(v), math.floor(u)
    if row < 0 or row >= rows or col < 0 or col >= cols:
        return 0.0
    r0, c0 = math.floor(v - 0.5), math.floor(u - 0.5)
    if r0 < 0 or r0 + 1 >= rows or c0 < 0 or c0 + 1 >= cols:
        return 0.0  # within half a cell of the world outside, which is unknown
    a, b = v - 0.5 - r0, u - 0.5 - c0
    low = (1.0 - b) * clearance[r0, c0] + b * clearance[r0, c0 + 1]
    high = (1.0 - b) * clearance[r0 + 1, c0] + b * clearance[r0 + 1, c0 + 1]
    return min((1.0 - a) * low + a * high, float(clearance[row, col]))


@njit(cache=True)
def segment_is_clear(clearance, u0, v0, u1, v1, floor, resolution):  # type: ignore[no-untyped-def]  # numba kernel
    """Whether no sample along a segment, both ends included, falls below a floor in metres.

    A distance falls no faster than one goes: where there is room to spare, samples are left out that cannot
    fall below. A point's value and the distance differ by 0.7 cells at most in one direction, by √2 cells
    in the other.
    """
    length = math.hypot(u1 - u0, v1 - v0)
    steps = max(1, math.ceil(length / STEP_CELLS))
    k = 0
    while k <= steps:
        t = k / steps
        here = clearance_at(clearance, u0 + t * (u1 - u0), v0 + t * (v1 - v0))
        if here < floor:
            return False
        spare = int(((here - floor) / resolution - _SPARE_CELLS) * steps / max(length, STEP_CELLS))
        k = min(k + max(1, spare), steps) if k < steps else steps + 1
    return True


@njit(cache=True)
def clearances_at(clearance, points):  # type: ignore[no-untyped-def]  # numba kernel
    """(N,) float64, metres, of (N, 2) points."""
    values = np.empty(len(points))
    for i in range(len(points)):
        values[i] = clearance_at(clearance, points[i, 0], points[i, 1])
    return values
