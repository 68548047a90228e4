"""Medial axis of the free space, read off the feature transform."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from explore_bt_planners.feature_transform import FeatureTransform

__all__ = ["medial_axis"]


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
    axis = np.zeros(transform.squared.shape, dtype=np.bool_)
    _mark(
        transform.squared, transform.row, transform.col, min_squared, float(min_separation_cells) ** 2, axis
    )
    return axis


@njit(cache=True)
def _mark(squared, row, col, min_squared, min_separation_squared, axis):  # type: ignore[no-untyped-def]  # numba kernel
    rows, cols = squared.shape
    for r in range(rows):
        for c in range(cols):
            own = squared[r, c]
            if own < min_squared:
                continue
            for k in range(4):
                nr = r + (k == 0) - (k == 1)
                nc = c + (k == 2) - (k == 3)
                if nr < 0 or nr >= rows or nc < 0 or nc >= cols or squared[nr, nc] > own:
                    continue
                dr = row[nr, nc] - row[r, c]
                dc = col[nr, nc] - col[r, c]
                if dr * dr + dc * dc >= min_separation_squared:
                    axis[r, c] = True
                    break
