"""Bringing a feature transform up to date where the map has changed, and nowhere else."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray

from explore_bt.types import FREE, GridWindow
from explore_bt_planners.feature_transform import FeatureTransform, transform_window

__all__ = ["changed_window", "grown", "paste", "update_transform"]

_STRIDE = 8  # cells by which a side of the window grows at a time


def changed_window(
    old: NDArray[np.int8], new: NDArray[np.int8], within: GridWindow
) -> tuple[GridWindow, int]:
    """The smallest window of all cells that have become or ceased to be obstacles, and their number.

    Args:
        old: (rows, cols) int8, see ``OccupancyGrid.cells``.
        new: the same shape.
        within: cells outside of it are taken for unchanged.
    """
    rows = (within.row0, within.row1)
    if within.col1 - within.col0 == new.shape[1]:
        rows = _differing_rows(old, new, *rows)
    *box, count = _changed(old, new, rows[0], within.col0, rows[1], within.col1)
    return GridWindow(*box), int(count)


def update_transform(transform: FeatureTransform, cells: NDArray[np.int8], changed: GridWindow) -> GridWindow:
    """Make a transform the one of ``cells``, in place; bit-equal to a full one.

    A cell can change only if its old distance reaches the changed window. The window grows by every side
    that still has such a cell, with one cell to spare: then none lies beyond, for along the straight way to
    the changed window a distance falls no faster than the way gets shorter. The cells on the grown
    window's sides keep their distances, and what is nearest to a cell inside but lies outside is no farther
    from a side than that side's own distance: so far one has to look.

    Args:
        transform: of the map before.
        cells: (rows, cols) int8, the map now.
        changed: holds all cells that differ; not empty.

    Returns:
        The window outside of which nothing has changed.
    """
    inner = (changed.row0, changed.col0, changed.row1, changed.col1)
    *box, row0, col0, row1, col1 = _reach(transform.squared, inner)
    window = GridWindow(*box)
    transform_window(transform, cells, window, GridWindow(row0, col0, row1, col1))
    return window


def grown(transform: FeatureTransform, shape: tuple[int, int], offset: tuple[int, int]) -> FeatureTransform:
    """The transform of the same obstacles on a larger map, all of whose new cells are obstacles.

    Args:
        transform: of the smaller map.
        shape: rows and columns of the larger one.
        offset: row and column in the larger map of the smaller one's first cell.
    """
    squared, row, col = (np.empty(shape, dtype=np.int32) for _ in range(3))
    _grow(transform.squared, transform.row, transform.col, *offset, squared, row, col)
    return FeatureTransform(squared, row, col)


def paste(large: NDArray[Any], small: NDArray[Any], offset: tuple[int, int]) -> NDArray[Any]:
    """``large`` with ``small`` written at ``offset`` (row, col); in place."""
    rows, cols = small.shape
    large[offset[0] : offset[0] + rows, offset[1] : offset[1] + cols] = small
    return large


def _differing_rows(old: NDArray[np.int8], new: NDArray[np.int8], row0: int, row1: int) -> tuple[int, int]:
    """The rows that may differ, found eight cells at a time."""
    cols = new.shape[1]
    before, now = (np.ascontiguousarray(each[row0:row1]).ravel() for each in (old, new))
    whole = before.size // 8 * 8
    first, last = _differing_words(before[:whole].view(np.uint64), now[:whole].view(np.uint64))
    if not np.array_equal(before[whole:], now[whole:]):
        return row0 + 8 * first // cols, row1
    return row0 + 8 * first // cols, row0 + min((8 * last + 7) // cols + 1, row1 - row0)


@njit(cache=True)
def _grow(old_squared, old_row, old_col, row0, col0, squared, row, col):  # type: ignore[no-untyped-def]  # numba kernel
    rows, cols = old_squared.shape
    for r in range(squared.shape[0]):
        inside = row0 <= r < row0 + rows
        for c in range(squared.shape[1]):
            if inside and col0 <= c < col0 + cols:
                squared[r, c] = old_squared[r - row0, c - col0]
                row[r, c] = old_row[r - row0, c - col0] + row0
                col[r, c] = old_col[r - row0, c - col0] + col0
            else:
                squared[r, c], row[r, c], col[r, c] = 0, r, c


@njit(cache=True)
def _differing_words(before, now):  # type: ignore[no-untyped-def]  # numba kernel
    """First and last word that differ; one past the end and one before the start if none does."""
    first, last = 0, before.size - 1
    while first <= last and before[first] == now[first]:
        first += 1
    while last > first and before[last] == now[last]:
        last -= 1
    return first, (last if first <= last else -1)


@njit(cache=True)
def _changed(old, new, row0, col0, row1, col1):  # type: ignore[no-untyped-def]  # numba kernel
    top, left, bottom, right, total = row1, col1, row0, col0, 0
    for r in range(row0, row1):
        before, now = old[r], new[r]
        count = 0
        for c in range(col0, col1):
            count += (before[c] == FREE) != (now[c] == FREE)
        if count == 0:
            continue
        total += count
        top, bottom = min(top, r), r + 1
        c = col0
        while c < left and (before[c] == FREE) == (now[c] == FREE):
            c += 1
        left = min(left, c)
        c = col1
        while c > right and (before[c - 1] == FREE) == (now[c - 1] == FREE):
            c -= 1
        right = max(right, c)
    return top, left, max(bottom, top), max(right, left), total


@njit(cache=True)
def _can_change(squared, r, c, inner):  # type: ignore[no-untyped-def]  # numba kernel
    """Whether a cell's distance, with one cell to spare, reaches the changed window."""
    dr = max(inner[0] - r, r - inner[2] + 1, 0)
    dc = max(inner[1] - c, c - inner[3] + 1, 0)
    return math.sqrt(squared[r, c]) + 1.0 + 1e-6 >= math.sqrt(dr * dr + dc * dc)


@njit(cache=True)
def _reach(squared, inner):  # type: ignore[no-untyped-def]  # numba kernel
    """The window that can change, and the one to look for obstacles in."""
    rows, cols = squared.shape
    row0, col0, row1, col1 = inner
    growing = True
    while growing:
        growing = False
        while row0 > 0 and _any(squared, row0, col0, row0 + 1, col1, inner):
            row0, growing = max(row0 - _STRIDE, 0), True
        while row1 < rows and _any(squared, row1 - 1, col0, row1, col1, inner):
            row1, growing = min(row1 + _STRIDE, rows), True
        while col0 > 0 and _any(squared, row0, col0, row1, col0 + 1, inner):
            col0, growing = max(col0 - _STRIDE, 0), True
        while col1 < cols and _any(squared, row0, col1 - 1, row1, col1, inner):
            col1, growing = min(col1 + _STRIDE, cols), True
    look = [row0, col0, row1, col1]
    for c in range(col0, col1):
        if row0 > 0:
            _take_in(look, squared[row0, c], row0, c)
        if row1 < rows:
            _take_in(look, squared[row1 - 1, c], row1 - 1, c)
    for r in range(row0, row1):
        if col0 > 0:
            _take_in(look, squared[r, col0], r, col0)
        if col1 < cols:
            _take_in(look, squared[r, col1 - 1], r, col1 - 1)
    return row0, col0, row1, col1, max(look[0], 0), max(look[1], 0), min(look[2], rows), min(look[3], cols)


@njit(cache=True)
def _take_in(look, squared, r, c):  # type: ignore[no-untyped-def]  # numba kernel
    radius = math.ceil(math.sqrt(squared)) + 1
    look[0], look[1] = min(look[0], r - radius), min(look[1], c - radius)
    look[2], look[3] = max(look[2], r + radius + 1), max(look[3], c + radius + 1)


@njit(cache=True)
def _any(squared, row0, col0, row1, col1, inner):  # type: ignore[no-untyped-def]  # numba kernel
    """Whether any cell of a box can change."""
    for r in range(row0, row1):
        for c in range(col0, col1):
            if _can_change(squared, r, c, inner):
                return True
    return False
