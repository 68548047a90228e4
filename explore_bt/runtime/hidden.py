"""Where someone may stand unseen: floor behind corners, with room for a body."""

from __future__ import annotations

import math

import cv2
import numpy as np
from numpy.typing import NDArray

from explore_bt.runtime.sight import Sight
from explore_bt.types import FREE, OCCUPIED, OccupancyGrid

__all__ = ["hidden_places"]

REACH_M = 3.5
"""Who stands farther off than this cannot come before the robot has slowed down."""
_SLIM_M = 0.2
"""Radius of a body: all of it is out of sight, and none of it in a wall."""
_CROSS = np.ones((3, 3), dtype=np.uint8)


def hidden_places(grid: OccupancyGrid, sight: Sight, reach_m: float = REACH_M) -> NDArray[np.float64]:
    """(K, 2) float64, metres, ``map`` frame: the edges of all such places around the robot.

    A person whose centre is in one of them shows nothing to the scan, and could step out next.

    Args:
        grid: the map; unknown space hides nobody, for it may well be a wall.
        sight: the newest scan.
        reach_m: how far around the robot.
    """
    row, col = grid.cell_of(*sight.origin.tolist())
    reach = math.ceil(reach_m / grid.resolution_m)
    row0, col0 = max(row - reach, 0), max(col - reach, 0)
    cells = grid.cells[row0 : max(row + reach + 1, 0), col0 : max(col + reach + 1, 0)]
    free = np.argwhere(cells == FREE)
    if not len(free):
        return np.empty((0, 2))
    shown = free[sight.shows(grid.centers_of(free + np.array([row0, col0])))]
    in_sight = np.zeros(cells.shape, dtype=np.bool_)
    in_sight[tuple(shown.T)] = True
    room = _distance(in_sight) > _SLIM_M / grid.resolution_m
    room &= _distance(cells == OCCUPIED) > _SLIM_M / grid.resolution_m
    hidden = ((cells == FREE) & room).astype(np.uint8)
    edge = hidden - cv2.erode(hidden, _CROSS)
    return grid.centers_of(np.argwhere(edge) + np.array([row0, col0]))


def _distance(mask: NDArray[np.bool_]) -> NDArray[np.float32]:
    """Cells from each to the nearest of the mask; very far where there is none."""
    return np.asarray(cv2.distanceTransform((~mask).astype(np.uint8), cv2.DIST_L2, cv2.DIST_MASK_PRECISE))
