"""How far somebody would have to walk to come to where the robot will be: round walls, not through them."""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from explore_bt.exploration import way_lengths
from explore_bt.types import OCCUPIED, OccupancyGrid, Pose2

__all__ = ["WalkingDistance", "spare_of_walkers_m"]

REACH_M = 4.0
"""Half the side of the window around the robot in which walls count."""
_SURELY_M = 3.0
"""So much of a way round walls counts: from beyond the window it is as far to where the robot can stop."""
_ODD_STEPS = 0.92
"""A way over eight neighbours is at most 1 / cos(22.5°) times as long as the straight one."""
_BODY_ROOM_M = 0.2
"""Around a source the map shows no walls, but the body itself."""


class WalkingDistance:
    """From the nearest of some discs, over everything that the map does not call occupied.

    Never more than the length of the shortest way of a body.
    """

    def __init__(
        self,
        grid: OccupancyGrid,
        near: Pose2,
        centres: NDArray[np.float64],
        radii_m: NDArray[np.float64],
    ) -> None:
        """Take the map around the robot.

        Args:
            grid: the newest map.
            near: where the robot is.
            centres: (K, 2) float64, metres, ``map`` frame: the discs that people, or whole rooms, are.
            radii_m: (K,) float64.
        """
        self._centres, self._radii_m = centres, radii_m
        self._resolution_m = grid.resolution_m
        window = grid.window_around(near.x, near.y, REACH_M)
        self._row0, self._col0 = window.row0, window.col0
        self._grid = grid
        cells = grid.cells[window.slices]
        self._field = self._walked(cells) if cells.size and len(centres) else np.empty((0, 0))

    def to(self, places: NDArray[np.float64]) -> NDArray[np.float64]:
        """(N,) metres from the edge of the nearest disc to (N, 2) places, ``map`` frame."""
        straight_m = _nearest_edge_m(places, self._centres, self._radii_m)
        rows, cols = (self._grid.cells_of(places) - np.array([self._row0, self._col0])).T
        inside = (rows >= 0) & (rows < self._field.shape[0]) & (cols >= 0) & (cols < self._field.shape[1])
        around_m = np.zeros(len(places))
        around_m[inside] = self._field[rows[inside], cols[inside]]
        return np.maximum(straight_m, around_m)

    def _walked(self, cells: NDArray[np.int8]) -> NDArray[np.float64]:
        """(rows, cols) metres, a lower bound."""
        corner = (
            self._grid.origin_xy[0] + (self._col0 + 0.5) * self._resolution_m,
            self._grid.origin_xy[1] + (self._row0 + 0.5) * self._resolution_m,
        )
        begin = _covered(cells.shape, self._resolution_m, corner, self._centres, self._radii_m)
        body = _covered(cells.shape, self._resolution_m, corner, self._centres, self._radii_m + _BODY_ROOM_M)
        passable = (cells != OCCUPIED) | body
        walked = way_lengths(passable, np.argwhere(begin), REACH_M / self._resolution_m)
        walked_m = (
            _ODD_STEPS * walked - math.sqrt(2.0)
        ) * self._resolution_m  # between any points of the cells
        return np.minimum(walked_m, _SURELY_M)


@njit(cache=True)
def spare_of_walkers_m(
    places: NDArray[np.float64],
    times_s: NDArray[np.float64],
    walkers: NDArray[np.float64],
    speed: float,
    acceleration: float,
) -> NDArray[np.float64]:
    """How far from all of these people places are sure to be at their times, in the open.

    Nobody is faster than ``speed``, and nobody changes their velocity faster than ``acceleration``: after a
    time t they are within a disc about where they began, and within one about where they were going.

    Args:
        places: (N, 2) metres, ``map`` frame.
        times_s: (N,) seconds, on the clock of the stamps.
        walkers: (K, 7) x, y, vx, vy, radius, stamp, and by how much the velocity may be wrong; metres and
            seconds, ``map`` frame.
        speed: m/s.
        acceleration: m/s².

    Returns:
        (N,) metres to the nearest edge of where one of them can be; below 0: they can be there.
    """
    out = np.full(places.shape[0], np.inf)
    for i in range(places.shape[0]):
        for k in range(walkers.shape[0]):
            x, y, vx, vy, radius, stamp, off = walkers[k]
            t = max(times_s[i] - stamp, 0.0)
            dx, dy = places[i, 0] - x, places[i, 1] - y
            away = math.hypot(dx, dy) - speed * t
            if math.isfinite(off):
                by_inertia = math.hypot(dx - vx * t, dy - vy * t) - (off + 0.5 * acceleration * t) * t
                away = max(away, by_inertia)
            out[i] = min(out[i], away - radius)
    return out


@njit(cache=True)
def _nearest_edge_m(
    places: NDArray[np.float64], centres: NDArray[np.float64], radii: NDArray[np.float64]
) -> NDArray[np.float64]:
    out = np.full(places.shape[0], np.inf)
    for i in range(places.shape[0]):
        for k in range(centres.shape[0]):
            away = math.hypot(places[i, 0] - centres[k, 0], places[i, 1] - centres[k, 1]) - radii[k]
            out[i] = min(out[i], away)
    return out


@njit(cache=True)
def _covered(shape, resolution, corner, centres, radii):  # type: ignore[no-untyped-def]  # numba kernel
    """Cells whose centres lie in a disc, and the one that holds its centre."""
    out = np.zeros(shape, dtype=np.bool_)
    for k in range(centres.shape[0]):
        x, y = (centres[k, 0] - corner[0]) / resolution, (centres[k, 1] - corner[1]) / resolution
        reach = max(radii[k] / resolution, 0.75)
        for row in range(max(int(y - reach), 0), min(int(y + reach) + 2, shape[0])):
            for col in range(max(int(x - reach), 0), min(int(x + reach) + 2, shape[1])):
                out[row, col] |= (row - y) ** 2 + (col - x) ** 2 <= reach**2
    return out
