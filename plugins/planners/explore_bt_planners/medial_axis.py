"""Medial axis of the free space, read off the feature transform."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from explore_bt.types import GridWindow
from explore_bt_planners.feature_transform import FeatureTransform

__all__ = ["mark_axis", "medial_axis"]


def medial_axis(
    transform: FeatureTransform, min_squared: int, min_separation_cells: float
) -> NDArray[np.bool_]:
    """Cells between two obstacles that lie far apart.

    A cell belongs to it if it is clear enough and a 4-neighbour, no clearer than the cell itself, has its
    nearest obstacle far from the cell's own. The neighbour need not be clear enough: where a passage is
    just wide enough the axis is one cell thick, and would break if it had to. This is a local function
    of the feature transform, so a partial update equals a full one; the separation is the pruning.

    Args:
        transform: the feature transform.
        min_squared: least squared distance (cells²) of a cell on the axis.
        min_separation_cells: least distance between the two nearest obstacles, cells.

    Returns:
        (rows, cols) bool.
    """
    rows, cols = transform.squared.shape
    axis = np.zeros((rows, cols), dtype=np.bool_)
    mark_axis(axis, transform, min_squared, min_separation_cells, GridWindow(0, 0, rows, cols))
    return axis


def mark_axis(
    axis: NDArray[np.bool_],
    transform: FeatureTransform,
    min_squared: int,
    min_separation_cells: float,
    window: GridWindow,
) -> None:
    """Write the medial axis of the cells in a window; arguments as for ``medial_axis``."""
    box = (window.row0, window.col0, window.row1, window.col1)
    separation_squared = float(min_separation_cells) ** 2
    _mark(transform.squared, transform.row, transform.col, min_squared, separation_squared, box, axis)


@njit(cache=True)
def _mark(squared, row, col, min_squared, min_separation_squared, box, axis):  # type: ignore[no-untyped-def]  # numba kernel
    rows, cols = squared.shape
    row0, col0, row1, col1 = box
    axis[row0:row1, col0:col1] = False
    for r in range(max(row0 - 1, 0), row1):
        above = min(r + 1, rows - 1)
        own, up = squared[r], squared[above]
        own_row, own_col, up_row, up_col = row[r], col[r], row[above], col[above]
        for c in range(max(col0 - 1, 0), col1):  # every cell with the one to its right and the one above
            right = min(c + 1, cols - 1)
            if own[c] < min_squared and own[right] < min_squared and up[c] < min_squared:
                continue
            dr, dc = own_row[right] - own_row[c], own_col[right] - own_col[c]
            if dr * dr + dc * dc >= min_separation_squared:
                _mark_clearer(squared, min_squared, box, r, c, r, right, axis)
            dr, dc = up_row[c] - own_row[c], up_col[c] - own_col[c]
            if dr * dr + dc * dc >= min_separation_squared:
                _mark_clearer(squared, min_squared, box, r, c, above, c, axis)


@njit(cache=True)
def _mark_clearer(squared, min_squared, box, r0, c0, r1, c1, axis):  # type: ignore[no-untyped-def]  # numba kernel
    """Of two neighbours the clearer one, or both if neither is."""
    one, other = squared[r0, c0], squared[r1, c1]
    if one >= other and one >= min_squared and box[0] <= r0 and box[1] <= c0:
        axis[r0, c0] = True
    if other >= one and other >= min_squared and box[0] <= r1 < box[2] and box[1] <= c1 < box[3]:
        axis[r1, c1] = True
