"""Exact Euclidean feature transform: for every cell, which obstacle cell is nearest."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray

from explore_bt.types import FREE, GridWindow

__all__ = ["FeatureTransform", "feature_transform", "transform_window"]

_NONE = -(1 << 20)  # row of the nearest obstacle of a column that holds none as far as one looks


@dataclass(frozen=True, slots=True, eq=False)
class FeatureTransform:
    """The nearest obstacle of every cell, between cell centres.

    It is a function of the set of obstacles alone: among equally near ones the lowest column wins, then
    the lowest row. So a partial update is bit-equal to a full one.

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
    squared, row, col = (np.empty(cells.shape, dtype=np.int32) for _ in range(3))
    transform = FeatureTransform(squared, row, col)
    whole = GridWindow(0, 0, *cells.shape)
    transform_window(transform, cells, whole, whole)
    return transform


def transform_window(
    transform: FeatureTransform, cells: NDArray[np.int8], window: GridWindow, seen: GridWindow
) -> None:
    """Write the transform of the cells in ``window``, looking for obstacles in ``seen`` only.

    Args:
        transform: written in place.
        cells: (rows, cols) int8 of the whole map.
        window: what to write.
        seen: holds ``window`` and every nearest obstacle of its cells; where it ends at the border of the
            map, the world outside is seen too.
    """
    nearest_row = transform.row  # of the whole map: each row is read before it is written
    if window != GridWindow(0, 0, *cells.shape):
        nearest_row = np.empty((seen.row1 - seen.row0, seen.col1 - seen.col0), dtype=np.int32)
    look = (seen.row0, seen.col0, seen.row1, seen.col1)
    _scan_columns(cells, *look, nearest_row)
    box = (window.row0, window.col0, window.row1, window.col1)
    _scan_rows(cells, nearest_row, look, box, transform.squared, transform.row, transform.col)


@njit(cache=True)
def _scan_columns(cells, row0, col0, row1, col1, nearest_row):  # type: ignore[no-untyped-def]  # numba kernel
    """Row of the nearest obstacle within the same column; the lower row wins a tie."""
    cols = col1 - col0
    last = np.full(cols, -1 if row0 == 0 else _NONE, dtype=np.int32)
    for r in range(row0, row1):
        here, nearest = cells[r, col0:col1], nearest_row[r - row0]
        for c in range(cols):  # without branches: several columns at once
            last[c] = last[c] if here[c] == FREE else r
            nearest[c] = last[c]
    last[:] = row1 if row1 == cells.shape[0] else -2 * _NONE
    for r in range(row1 - 1, row0 - 1, -1):
        here, nearest = cells[r, col0:col1], nearest_row[r - row0]
        for c in range(cols):
            last[c] = last[c] if here[c] == FREE else r
            nearest[c] = last[c] if last[c] - r < r - nearest[c] else nearest[c]


@njit(cache=True)
def _scan_rows(cells, nearest_row, look, box, squared, row, col):  # type: ignore[no-untyped-def]  # numba kernel
    look_row0, look_col0, _, look_col1 = look
    row0, col0, row1, col1 = box
    width = look_col1 - look_col0
    site = np.empty(width + 2, dtype=np.int32)  # columns on the lower envelope
    height = np.empty(width + 2, dtype=np.int32)  # their squared vertical distances
    begin = np.empty(width + 2, dtype=np.int32)  # first column each of them wins
    nearest = np.empty(width, dtype=np.int32)
    for r in range(row0, row1):
        nearest[:] = nearest_row[r - look_row0]
        c = col0
        while c < col1:
            if cells[r, c] != FREE:
                squared[r, c] = 0
                row[r, c] = r
                col[r, c] = c
                c += 1
                continue
            first, end = c, c + 1
            while first > look_col0 and cells[r, first - 1] == FREE:
                first -= 1
            while end < look_col1 and cells[r, end] == FREE:
                end += 1
            # a run cut off by the edge of what is seen has no obstacle there
            closed = (first > look_col0 or first == 0, end < look_col1 or end == cells.shape[1])
            run = (first, end, c, min(end, col1))
            _free_run(r, run, closed, nearest, look_col0, squared, row, col, site, height, begin)
            c = end


@njit(cache=True, error_model="numpy")
def _free_run(r, run, closed, nearest_row, origin, squared, row, col, site, height, begin):  # type: ignore[no-untyped-def]  # numba kernel
    """Lower envelope of the parabolas of columns first-1 .. end, read off at write .. until-1."""
    first, end, write, until = run
    top, s, h, t = -1, 0, 0, first  # the envelope's last parabola, kept out of the arrays
    if closed[0]:
        top, s = 0, first - 1
        site[0], height[0], begin[0] = s, 0, first
    for u in range(first, end + 1 if closed[1] else end):
        g = nearest_row[u - origin] - r if u < end else 0
        if g <= _NONE // 2:
            continue  # nothing seen in this column
        g2 = g * g
        while top >= 0 and (t - s) * (t - s) + h > (t - u) * (t - u) + g2:
            top -= 1
            if top >= 0:
                s, h, t = site[top], height[top], begin[top]
        start = first
        if top >= 0:
            # the quotient of exact integers this small is never rounded across an integer
            rise = u * u - s * s + g2 - h
            start = 1 + math.floor(rise / (2.0 * (u - s)))
        if start < end:
            top += 1
            s, h, t = u, g2, start
            site[top], height[top], begin[top] = s, h, t
    for x in range(until - 1, write - 1, -1):
        while t > x:
            top -= 1
            s, h, t = site[top], height[top], begin[top]
        squared[r, x] = (x - s) * (x - s) + h
        col[r, x] = s
        row[r, x] = nearest_row[s - origin] if first <= s < end else r
