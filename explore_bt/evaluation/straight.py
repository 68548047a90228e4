"""Straight lines across a mask of cells."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

__all__ = ["is_open_line", "straightened"]


@njit(cache=True)
def _is_open(mask, row, col, to_row, to_col):  # type: ignore[no-untyped-def]  # numba kernel
    """Whether the mask holds at every half cell of a line between two cells' centres."""
    count = 2 * max(abs(to_row - row), abs(to_col - col)) + 1
    for i in range(count + 1):
        share = i / count
        if not mask[round(row + share * (to_row - row)), round(col + share * (to_col - col))]:
            return False
    return True


@njit(cache=True)
def _are_open(mask, begins, ends):  # type: ignore[no-untyped-def]  # numba kernel
    result = np.empty(begins.shape[0], dtype=np.bool_)
    for i in range(begins.shape[0]):
        result[i] = _is_open(mask, begins[i, 0], begins[i, 1], ends[i, 0], ends[i, 1])
    return result


def is_open_line(
    mask: NDArray[np.bool_], begins: NDArray[np.int64], ends: NDArray[np.int64]
) -> NDArray[np.bool_]:
    """(N,) bool: whether the lines between (N, 2) and (N, 2) cells stay on the mask."""
    return np.asarray(_are_open(mask, np.ascontiguousarray(begins), np.ascontiguousarray(ends)))


@njit(cache=True)
def _pull(mask, cells, kept):  # type: ignore[no-untyped-def]  # numba kernel
    """Numbers of the cells to keep: from each go to the last one that doubling and halving finds in view."""
    count, here, last = 1, 0, cells.shape[0] - 1
    kept[0] = 0
    while here < last:
        span, step = 1, 2
        while here + step <= last and _is_open(
            mask, cells[here, 0], cells[here, 1], cells[here + step, 0], cells[here + step, 1]
        ):
            span, step = step, 2 * step
        step //= 2
        while step > 0:
            there = here + span + step
            if there <= last and _is_open(
                mask, cells[here, 0], cells[here, 1], cells[there, 0], cells[there, 1]
            ):
                span += step
            step //= 2
        here += span
        kept[count] = here
        count += 1
    return count


def straightened(cells: NDArray[np.int64], mask: NDArray[np.bool_]) -> NDArray[np.int64]:
    """A way with straight lines wherever they stay on the mask (string pulling).

    Args:
        cells: (N, 2) rows and columns on the mask, each a neighbour of the one before or the same; N >= 1.
        mask: (rows, cols) bool.

    Returns:
        (M, 2), M <= N, first and last cell unchanged.
    """
    kept = np.empty(len(cells), dtype=np.int64)
    count = _pull(np.ascontiguousarray(mask), np.ascontiguousarray(cells), kept)
    return cells[kept[:count]]
