"""The shortest way that a travel field promises."""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from explore_bt.exploration.kernel_input import read_only

__all__ = ["way_down"]

_DIAGONAL = math.sqrt(2.0)


@njit(cache=True)
def _descend(travel, row, col, way):  # type: ignore[no-untyped-def]  # numba kernel
    """Fill ``way`` with the cells from (row, col) down to where no neighbour is lower; how many."""
    rows, cols = travel.shape
    way[0, 0], way[0, 1] = row, col
    count = 1
    while count < way.shape[0] and travel[row, col] > 0.0:
        steepest, to_row, to_col = 0.0, row, col
        for d_row in range(-1, 2):
            for d_col in range(-1, 2):
                r, c = row + d_row, col + d_col
                if (d_row == 0 and d_col == 0) or not (0 <= r < rows and 0 <= c < cols):
                    continue
                length = 1.0
                if d_row != 0 and d_col != 0:  # no corner is cut, as in the field itself
                    if not (np.isfinite(travel[row, c]) and np.isfinite(travel[r, col])):
                        continue
                    length = _DIAGONAL
                slope = (travel[row, col] - travel[r, c]) / length
                if slope > steepest:
                    steepest, to_row, to_col = slope, r, c
        if steepest == 0.0:
            break
        row, col = to_row, to_col
        way[count, 0], way[count, 1] = row, col
        count += 1
    return count


def way_down(travel_m: NDArray[np.float32], cell: tuple[int, int]) -> NDArray[np.int64]:
    """The cells from the field's start to a cell, each a neighbour of the one before.

    Args:
        travel_m: (rows, cols) float32, as from :func:`travel_field`.
        cell: (row, col) with a finite travel.

    Returns:
        (N, 2) int64 rows and columns; N = 1 if the cell is the start.
    """
    way = np.empty((travel_m.size, 2), dtype=np.int64)
    count = _descend(read_only(travel_m), cell[0], cell[1], way)
    return way[count - 1 :: -1] if count > 1 else way[:1].copy()
