"""Coverage: the share of the true floor that a map knows."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from explore_bt.errors import WorldError
from explore_bt.types import FREE, UNKNOWN, OccupancyGrid

__all__ = ["CoverageMeter", "coverage"]

_NEIGHBOURS = np.ones((3, 3), dtype=np.uint8)


class CoverageMeter:
    """Measures maps of any resolution and origin against one true floor, in the same frame.

    A floor cell counts as mapped if the map cell at its centre is known (not unknown), and that cell or
    one of its eight neighbours is free. So a floor cell at the foot of a wall counts even where noise has
    drawn the wall a cell too thick, while a wall drawn through unseen floor earns nothing.
    """

    def __init__(self, truth_floor: OccupancyGrid) -> None:
        """Prepares the floor.

        Args:
            truth_floor: its ``FREE`` cells are the floor.

        Raises:
            WorldError: if there is no such cell.
        """
        floor = truth_floor.free
        rows, cols = np.flatnonzero(floor.any(axis=1)), np.flatnonzero(floor.any(axis=0))
        if rows.size == 0:
            raise WorldError("true floor: no free cell found, expected at least one; check the world file")
        self._floor = floor[rows[0] : rows[-1] + 1, cols[0] : cols[-1] + 1].copy()
        centers = truth_floor.resolution_m * (0.5 + np.arange(max(floor.shape)))
        self._x = truth_floor.origin_xy[0] + centers[cols[0] : cols[-1] + 1]
        self._y = truth_floor.origin_xy[1] + centers[rows[0] : rows[-1] + 1]
        self._count = int(np.count_nonzero(self._floor))
        self._mapped = np.zeros(self._floor.shape, dtype=np.bool_)
        self._mapped_count = 0

    def measure(self, grid: OccupancyGrid) -> float:
        """Share of the floor that the map knows, in [0, 1]."""
        rows, cols = self._floor.shape
        return self._measure_within(grid, slice(0, rows), slice(0, cols))

    def measure_around(self, grid: OccupancyGrid, xy: tuple[float, float], reach_m: float) -> float:
        """The same for a map that has changed nowhere but within reach of a place since the last call.

        Args:
            grid: the map now.
            xy: metres, ``map`` frame.
            reach_m: half the side of a square about it.
        """
        margin_m = reach_m + 2.0 * grid.resolution_m  # a floor cell looks at the neighbours of its map cell
        rows, cols = (
            slice(*np.searchsorted(centers, (middle - margin_m, middle + margin_m)).tolist())
            for centers, middle in ((self._y, xy[1]), (self._x, xy[0]))
        )
        return self._measure_within(grid, rows, cols)

    def _measure_within(self, grid: OccupancyGrid, rows: slice, cols: slice) -> float:
        """Look again at some floor cells; the share of all."""
        mapped, floor = self._mapped[rows, cols], self._floor[rows, cols]
        self._mapped_count -= int(np.count_nonzero(mapped))
        mapped[:] = _mapped_at(grid, self._x[cols], self._y[rows]) & floor
        self._mapped_count += int(np.count_nonzero(mapped))
        return self._mapped_count / self._count


def _mapped_at(grid: OccupancyGrid, x: NDArray[np.float64], y: NDArray[np.float64]) -> NDArray[np.bool_]:
    """(rows, cols) bool: whether the map's cells at x by y are known and free, or beside a free one."""
    if x.size == 0 or y.size == 0:
        return np.zeros((y.size, x.size), dtype=np.bool_)
    col, row = _cells_along(x, grid.origin_xy[0], grid), _cells_along(y, grid.origin_xy[1], grid)
    rows, cols = grid.shape
    low_row, low_col = (int(np.clip(index[0] - 1, 0, n)) for index, n in ((row, rows), (col, cols)))
    high_row, high_col = (int(np.clip(index[-1] + 2, 0, n)) for index, n in ((row, rows), (col, cols)))
    window = grid.cells[low_row:high_row, low_col:high_col]
    if window.size == 0:
        return np.zeros((y.size, x.size), dtype=np.bool_)
    near_free = cv2.dilate((window == FREE).astype(np.uint8), _NEIGHBOURS)
    mapped = np.pad((window != UNKNOWN) & (near_free > 0), 1)  # the rim stands for the world outside
    row = np.clip(row - low_row, -1, high_row - low_row) + 1
    col = np.clip(col - low_col, -1, high_col - low_col) + 1
    return mapped[row][:, col]


def _cells_along(centers: NDArray[np.float64], origin: float, grid: OccupancyGrid) -> NDArray[np.intp]:
    return np.floor((centers - origin) / grid.resolution_m).astype(np.intp)


def coverage(truth_floor: OccupancyGrid, grid: OccupancyGrid) -> float:
    """Share in [0, 1] of a true floor that a map knows; see :class:`CoverageMeter`."""
    return CoverageMeter(truth_floor).measure(grid)
