"""Where to let somebody pass whose way is known."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from explore_bt.exploration.travel import Travel
from explore_bt.types import OccupancyGrid

__all__ = ["find_sidestep"]


def find_sidestep(
    grid: OccupancyGrid,
    clearance_m: NDArray[np.float32],
    here_xy: tuple[float, float],
    radius_m: float,
    course_xy: NDArray[np.float64],
    apart_m: float,
    *,
    most_way_m: float = 15.0,
) -> tuple[float, float] | None:
    """The nearest place off somebody's course that the robot comes to without passing them; None if none is.

    Args:
        grid: the map.
        clearance_m: (rows, cols) float32, as from :func:`clearance_field`.
        here_xy: the robot, metres, ``map`` frame.
        radius_m: the footprint with what it shall have to spare.
        course_xy: (M, 2) metres, M >= 1: where their centre passes, where it is now first.
        apart_m: what has to be between the two centres.
        most_way_m: no farther away than this.
    """
    row, col = grid.cell_of(*here_xy)
    reach = math.ceil(most_way_m / grid.resolution_m)
    row0, col0 = max(row - reach, 0), max(col - reach, 0)
    window = clearance_m[row0 : row + reach + 1, col0 : col + reach + 1].copy()
    begin = np.array([row0, col0])
    rows, cols = np.indices(window.shape)
    centres = grid.centers_of(np.stack((rows.ravel(), cols.ravel()), axis=1) + begin)
    from_them_m = np.hypot(*(centres - course_xy[0]).T).reshape(window.shape)
    gap_m = math.dist(here_xy, course_xy[0].tolist())
    window[from_them_m < min(apart_m, gap_m - grid.resolution_m)] = 0.0
    way_m = Travel(window, radius_m, grid.resolution_m).field((row - row0, col - col0), most_way_m)
    cells = np.argwhere(way_m <= most_way_m)
    if not len(cells):
        return None
    places, ways_m = grid.centers_of(cells + begin), way_m[tuple(cells.T)]
    off_m = np.full(len(places), np.inf)
    for spot in course_xy:
        off_m = np.minimum(off_m, np.hypot(*(places - spot).T))
    is_off = off_m >= apart_m
    if not is_off.any():
        return None
    x, y = places[int(np.argmin(np.where(is_off, ways_m, np.inf)))].tolist()
    return (x, y)
