"""Exact Euclidean feature transform: for every cell, which obstacle cell is nearest."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray

from explore_bt.types import FREE

__all__ = ["FeatureTransform", "feature_transform"]


@dataclass(frozen=True, slots=True, eq=False)
class FeatureTransform:
    """The nearest obstacle of every cell, between cell centres.

    It is a function of the set of obstacles alone: among equally near ones the lowest column wins, then
    the lowest row. So a partial update can be bit-equal to a full one.

    Attributes:
        squared: (rows, cols) int32, squared distance in cells; 0 on obstacles.
        row, col: (rows, cols) int32, the nearest obstacle cell; -1 or ``rows``/``cols`` lie outside.
    """

    squared: NDArray[np.int32]
    row: NDArray[np.int32]
    col: NDArray[np.int32]


def feature_transform(cells: NDArray[np.int8]) -> FeatureTransform:
    """Transform a trinary map; what is not ``FREE`` is an obstacle, and so is the world outside.

    Meijster, Roerdink and Hesselink, "A general algorithm for computing distance transforms in linear
    time", 2000; exact in integers. Rows are cut at their obstacles: nothing beyond an obstacle in the
    same row can be nearer than that obstacle, so the work is proportional to the free floor.

    Args:
        cells: (rows, cols) int8, see ``OccupancyGrid.cells``.
    """
    nearest_row = np.empty(cells.shape, dtype=np.int32)
    squared = np.empty(cells.shape, dtype=np.int32)
    row = np.empty(cells.shape, dtype=np.int32)
    col = np.empty(cells.shape, dtype=np.int32)
    _scan_columns(cells, nearest_row)
    _scan_rows(cells, nearest_row, squared, row, col)
    return FeatureTransform(squared, row, col)


@njit(cache=True)
def _scan_columns(cells, nearest_row):  # type: ignore[no-untyped-def]  # numba kernel
    """Row of the nearest obstacle within the same column; the lower row wins a tie."""
    rows, cols = cells.shape
    last = np.full(cols, -1, dtype=np.int32)
    for r in range(rows):
        for c in range(cols):
            if cells[r, c] != FREE:
                last[c] = r
            nearest_row[r, c] = last[c]
    last[:] = rows
    for r in range(rows - 1, -1, -1):
        for c in range(cols):
            if cells[r, c] != FREE:
                last[c] = r
            elif last[c] - r < r - nearest_row[r, c]:
                nearest_row[r, c] = last[c]


@njit(cache=True)
def _scan_rows(cells, nearest_row, squared, row, col):  # type: ignore[no-untyped-def]  # numba kernel
    rows, cols = cells.shape
    site = np.empty(cols + 2, dtype=np.int64)  # columns on the lower envelope
    height = np.empty(cols + 2, dtype=np.int64)  # their squared vertical distances
    begin = np.empty(cols + 2, dtype=np.int64)  # first column each of them wins
    for r in range(rows):
        c = 0
        while c < cols:
            if cells[r, c] != FREE:
                squared[r, c] = 0
                row[r, c] = r
                col[r, c] = c
                c += 1
                continue
            end = c
            while end < cols and cells[r, end] == FREE:
                end += 1
            _free_run(r, c, end, nearest_row, squared, row, col, site, height, begin)
            c = end


@njit(cache=True)
def _free_run(r, first, end, nearest_row, squared, row, col, site, height, begin):  # type: ignore[no-untyped-def]  # numba kernel
    """Lower envelope of the parabolas of columns first-1 .. end, read off at first .. end-1."""
    top = 0
    site[0], height[0], begin[0] = first - 1, 0, first
    for u in range(first, end + 1):
        g = nearest_row[r, u] - r if u < end else 0
        g2 = g * g
        while top >= 0:
            t = begin[top]
            if (t - site[top]) ** 2 + height[top] <= (t - u) ** 2 + g2:
                break
            top -= 1
        if top < 0:
            start = first
        else:
            # the quotient of exact integers this small is never rounded across an integer
            rise = u * u - site[top] * site[top] + g2 - height[top]
            start = 1 + math.floor(rise / (2.0 * (u - site[top])))
        if start < end:
            top += 1
            site[top], height[top], begin[top] = u, g2, start
    for x in range(end - 1, first - 1, -1):
        while begin[top] > x:
            top -= 1
        s = site[top]
        squared[r, x] = (x - s) ** 2 + height[top]
        col[r, x] = s
        row[r, x] = nearest_row[r, s] if first <= s < end else r
