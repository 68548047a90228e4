"""The outline of a grid's solid cells as segments, solid on the left."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["grid_outline"]


def grid_outline(
    solid: NDArray[np.bool_], resolution_m: float, origin_xy: tuple[float, float]
) -> NDArray[np.float64]:
    """Edges between solid and free cells, those in line joined; the outside of the grid is solid.

    Args:
        solid: (rows, cols) bool, row 0 at the lowest y.
        resolution_m: metres per cell.
        origin_xy: lower left corner of cell (0, 0), metres.

    Returns:
        (M, 4) float64, metres: x, y of begin and end.
    """
    padded = np.pad(solid, 1, constant_values=True).astype(np.int8)
    # +1: solid before (west, south) and free after; -1: the other way round
    across_x = (padded[1:-1, :-1] - padded[1:-1, 1:]).T
    across_y = padded[:-1, 1:-1] - padded[1:, 1:-1]
    column, low, high, sign = _runs(across_x)
    upright = np.where(sign > 0, [column, low, column, high], [column, high, column, low]).T
    row, low, high, sign = _runs(across_y)
    level = np.where(sign > 0, [high, row, low, row], [low, row, high, row]).T
    corners = np.concatenate((upright, level)).astype(np.float64)
    return corners * resolution_m + np.tile(np.asarray(origin_xy), 2)


def _runs(
    lines: NDArray[np.int8],
) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.int64], NDArray[np.int8]]:
    """Line, begin, end and value of every run of equal values other than 0 along each row."""
    walled = np.pad(lines, ((0, 0), (1, 1)))
    change = np.diff(walled, axis=1) != 0
    begins = np.argwhere(change & (walled[:, 1:] != 0))
    ends = np.argwhere(change & (walled[:, :-1] != 0))
    return begins[:, 0], begins[:, 1], ends[:, 1], lines[begins[:, 0], begins[:, 1]]
