"""Where someone may be unseen: floor that was in sight is clear until somebody could have walked there.

The contaminated part of the floor, as in pursuit and evasion (Guibas et al., 1999): each scan clears what it
shows, and from what is left unseen people spread at walking speed.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import cv2
import numpy as np
from numpy.typing import NDArray

from explore_bt.runtime.sight import Sight
from explore_bt.types import FREE, OCCUPIED, MovingObstacle, OccupancyGrid

__all__ = ["HiddenFloor"]

REACH_M = 4.0
"""Half the side of the window that is watched; beyond it everything counts as unseen."""
STROLL_MPS = 1.4
_SLIM_M = 0.2
"""Radius of a body: none of it is in sight, and none of it in a wall."""
_TIE = 1e-6
_CROSS = np.ones((3, 3), dtype=np.uint8)


class HiddenFloor:
    """Follows which floor around the robot may hide someone."""

    def __init__(self) -> None:
        self._hidden = np.zeros((0, 0), dtype=np.uint8)
        self._corner: tuple[int, int] = (0, 0)
        self._stamp_s = -math.inf
        self._carried_m = 0.0
        self._resolution_m = 1.0

    def see(
        self, grid: OccupancyGrid, sight: Sight, people: Sequence[MovingObstacle] = ()
    ) -> NDArray[np.float64]:
        """(K, 2) float64, metres, ``map`` frame: the edge of where a centre of someone unseen may be.

        Args:
            grid: the map; unknown space hides nobody, for it may well be a wall.
            sight: the newest scan.
            people: who was seen a moment ago; once out of sight they may be anywhere near.
        """
        x, y = sight.origin.tolist()
        window = grid.window_around(x, y, REACH_M)
        corner, cells = (window.row0, window.col0), grid.cells[window.slices]
        free = np.argwhere(cells == FREE)
        if not len(free):
            return np.empty((0, 2))
        places = grid.centers_of(free + np.array(corner))
        in_sight = np.zeros(cells.shape, dtype=np.bool_)
        in_sight[tuple(free[sight.shows(places)].T)] = True
        slim = _SLIM_M / grid.resolution_m
        has_room = (cells == FREE) & (_distance(in_sight) > slim) & (_distance(cells == OCCUPIED) > slim)
        before = self._before(grid, corner, cells.shape)
        for place in grid.cells_of(np.array([thing.at(sight.stamp_s) for thing in people]).reshape(-1, 2)):
            row, col = place - np.array(corner)
            if 0 <= row < before.shape[0] and 0 <= col < before.shape[1]:
                before[row, col] = 1
        spread = self._spread(before, sight.stamp_s, grid.resolution_m)
        self._hidden = (spread & has_room).astype(np.uint8)
        self._corner = self._lattice(grid, *corner)
        self._stamp_s, self._resolution_m = sight.stamp_s, grid.resolution_m
        edge = self._hidden - cv2.erode(self._hidden, _CROSS)
        return grid.centers_of(np.argwhere(edge) + np.array(corner))

    def may_hide(self, place: NDArray[np.float64]) -> bool:
        """Whether the centre of someone unseen may be at (2,) x, y, metres, ``map`` frame."""
        col, row = np.floor(place / self._resolution_m + _TIE).astype(int) - self._corner[::-1]
        rows, cols = self._hidden.shape
        return not (0 <= row < rows and 0 <= col < cols) or bool(self._hidden[row, col])

    def _before(
        self, grid: OccupancyGrid, corner: tuple[int, int], shape: tuple[int, ...]
    ) -> NDArray[np.uint8]:
        """What was hidden, in the new window; all of it where the old window did not reach."""
        out = np.ones(shape, dtype=np.uint8)
        row0, col0 = self._lattice(grid, *corner)
        rows, cols = self._hidden.shape
        top, left = max(self._corner[0], row0), max(self._corner[1], col0)
        bottom = min(self._corner[0] + rows, row0 + shape[0])
        right = min(self._corner[1] + cols, col0 + shape[1])
        if top < bottom and left < right:
            old = self._hidden[
                top - self._corner[0] : bottom - self._corner[0],
                left - self._corner[1] : right - self._corner[1],
            ]
            out[top - row0 : bottom - row0, left - col0 : right - col0] = old
        return out

    def _spread(self, before: NDArray[np.uint8], stamp_s: float, resolution_m: float) -> NDArray[np.bool_]:
        """Whoever is hidden walks on; what is less than a cell is kept for the next time."""
        walked_m = self._carried_m + STROLL_MPS * min(stamp_s - self._stamp_s, 1e3)
        cells = math.floor(walked_m / resolution_m)
        self._carried_m = walked_m - cells * resolution_m
        if cells == 0:
            return before > 0
        return np.asarray(_distance(before > 0) <= cells)

    @staticmethod
    def _lattice(grid: OccupancyGrid, row: int, col: int) -> tuple[int, int]:
        """Row and column counted from the map frame's origin, which stays where it is when the map grows."""
        x, y = grid.origin_xy
        return row + round(y / grid.resolution_m), col + round(x / grid.resolution_m)


def _distance(mask: NDArray[np.bool_]) -> NDArray[np.float32]:
    """Cells from each to the nearest of the mask; very far where there is none."""
    return np.asarray(cv2.distanceTransform((~mask).astype(np.uint8), cv2.DIST_L2, cv2.DIST_MASK_PRECISE))
