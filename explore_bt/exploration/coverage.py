"""Coverage: the share of the true floor that a map knows."""

from __future__ import annotations

import cv2
import numpy as np

from explore_bt.errors import WorldError
from explore_bt.types import OccupancyGrid

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

    def measure(self, grid: OccupancyGrid) -> float:
        """Share of the floor that the map knows, in [0, 1]."""
        near_free = cv2.dilate(grid.free.astype(np.uint8), _NEIGHBOURS)
        mapped = np.pad(~grid.unknown & (near_free > 0), 1)  # the rim stands for the world outside
        rows, cols = grid.shape
        row = np.floor((self._y - grid.origin_xy[1]) / grid.resolution_m).clip(-1, rows).astype(np.intp) + 1
        col = np.floor((self._x - grid.origin_xy[0]) / grid.resolution_m).clip(-1, cols).astype(np.intp) + 1
        return int(np.count_nonzero(mapped[row][:, col] & self._floor)) / self._count


def coverage(truth_floor: OccupancyGrid, grid: OccupancyGrid) -> float:
    """Share in [0, 1] of a true floor that a map knows; see :class:`CoverageMeter`."""
    return CoverageMeter(truth_floor).measure(grid)
