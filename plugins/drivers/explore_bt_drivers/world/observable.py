"""Which floor a robot can reach, and which it can see from there."""

from __future__ import annotations

import math

import cv2
import numpy as np
from numba import njit
from numpy.typing import NDArray

from explore_bt.types import FREE, UNKNOWN, OccupancyGrid
from explore_bt_drivers.world.index import fits
from explore_bt_drivers.world.world import World

__all__ = ["SPARE_M", "fitting_cells", "observable_floor", "reachable_cells"]

SPARE_M = 0.025
"""A way counts only if it leaves this much on either side: through an exact fit no lidar guides a robot."""
_VIEWPOINT_SPACING_M = 0.3
_RAYS = 720
_TOUCH_M = 1e-6


def fitting_cells(world: World, radius_m: float) -> NDArray[np.bool_]:
    """(rows, cols) bool over ``world.floor``: a disc of that radius fits about the cell's centre."""
    cells = np.argwhere(world.floor.free)
    result = np.zeros(world.floor.shape, dtype=np.bool_)
    room = fits(world.index, world.floor.centers_of(cells), max(radius_m - _TOUCH_M, 0.0))
    result[cells[:, 0], cells[:, 1]] = room
    return result


def reachable_cells(world: World, start_xy: tuple[float, float], radius_m: float) -> NDArray[np.bool_]:
    """(rows, cols) bool: fitting cells joined (eight neighbours) to the one nearest to the start."""
    fitting = fitting_cells(world, radius_m)
    cells = np.argwhere(fitting)
    if len(cells) == 0:
        return fitting
    away = world.floor.centers_of(cells) - np.asarray(start_xy)
    row, col = cells[int(np.argmin(np.hypot(away[:, 0], away[:, 1])))]
    _, labels = cv2.connectedComponents(fitting.astype(np.uint8), connectivity=8)
    return np.asarray(labels == labels[row, col])


def observable_floor(
    world: World, start_xy: tuple[float, float], radius_m: float, range_m: float
) -> OccupancyGrid:
    """The floor cells within range and line of sight of a reachable place.

    Places are taken about every 0.3 m, with 720 rays each; sight ends at the first cell that is no floor.

    Returns:
        The world's floor grid, with observable cells ``FREE`` and all others ``UNKNOWN``.
    """
    floor = world.floor
    viewpoints = _thinned(reachable_cells(world, start_xy, radius_m), floor.resolution_m)
    seen = np.zeros(floor.shape, dtype=np.bool_)
    _look_around(floor.free, viewpoints, range_m / floor.resolution_m, _RAYS, seen)
    return OccupancyGrid(np.where(seen, FREE, UNKNOWN).astype(np.int8), floor.resolution_m, floor.origin_xy)


def _thinned(cells: NDArray[np.bool_], resolution_m: float) -> NDArray[np.int64]:
    """(N, 2) rows and columns: of every 0.3 m square the cell nearest to its middle, if it has any."""
    side = max(round(_VIEWPOINT_SPACING_M / resolution_m), 1)
    places = np.argwhere(cells)
    block = places // side
    off_centre = np.abs(places % side - (side - 1) / 2).sum(axis=1)
    order = np.lexsort((off_centre, block[:, 1], block[:, 0]))
    _, first = np.unique(block[order], axis=0, return_index=True)
    return places[order[first]]


@njit(cache=True)
def _look_around(free, viewpoints, reach, rays, seen):  # type: ignore[no-untyped-def]  # kernel
    """Mark the free cells along rays from the centres of viewpoint cells, ``reach`` cells far."""
    rows, cols = free.shape
    for ray in range(rays):
        angle = 2.0 * math.pi * (ray + 0.5) / rays
        dx, dy = math.cos(angle), math.sin(angle)
        step_col = 1 if dx > 0.0 else -1
        step_row = 1 if dy > 0.0 else -1
        per_col, per_row = 1.0 / abs(dx), 1.0 / abs(dy)
        for v in range(viewpoints.shape[0]):
            row, col = viewpoints[v, 0], viewpoints[v, 1]
            next_x, next_y = 0.5 * per_col, 0.5 * per_row
            entered = 0.0
            while entered <= reach and free[row, col]:
                seen[row, col] = True
                if next_x < next_y:
                    entered = next_x
                    next_x += per_col
                    col += step_col
                else:
                    entered = next_y
                    next_y += per_row
                    row += step_row
                if row < 0 or col < 0 or row >= rows or col >= cols:
                    break
