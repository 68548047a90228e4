"""What the map says about the surroundings, where the scan has nothing to say."""

from __future__ import annotations

from dataclasses import replace

import cv2
import numpy as np
from numba import njit
from numpy.typing import NDArray

from explore_bt.exploration import clearance_field
from explore_bt.types import FREE, OCCUPIED, OccupancyGrid, Pose2

__all__ = ["ClearanceWindow"]

_NEIGHBOURS = np.ones((3, 3), dtype=np.uint8)


class ClearanceWindow:
    """Clearance of the map around the robot; outside the window nothing is known, so nothing is free.

    An obstacle that the scan shows is judged by the scan, which is finer than a cell. The map answers for
    what the scan does not show: things out of its sight or plane, and unknown space.
    """

    def __init__(self, reach_m: float) -> None:
        self._reach_m = reach_m
        self._field = np.zeros((1, 1), dtype=np.float32)
        self._origin_xy = (0.0, 0.0)
        self._resolution_m = 1.0

    def cut(self, grid: OccupancyGrid, near: Pose2, seen: NDArray[np.float64]) -> None:
        """Take the map around ``near``, without the obstacles that the scan's points (N, 2) show."""
        window = grid.window_around(near.x, near.y, self._reach_m)
        if window.is_empty:
            self._field = np.zeros((1, 1), dtype=np.float32)
            return
        resolution = grid.resolution_m
        corner = np.array([window.col0, window.row0]) * resolution
        origin = (grid.origin_xy[0] + float(corner[0]), grid.origin_xy[1] + float(corner[1]))
        cut = OccupancyGrid(grid.cells[window.slices], resolution, origin)
        self._field = clearance_field(_without_seen(cut, seen))
        self._origin_xy = origin
        self._resolution_m = resolution

    def clearance_m(
        self, positions: NDArray[np.float64], *, between_cells: bool = False
    ) -> NDArray[np.float64]:
        """(N,) metres at (N, 2) positions.

        Args:
            positions: metres, ``map`` frame.
            between_cells: where exactly in its cell a position lies counts; else the cell's centre does,
                which is up to half a cell nearer or farther.
        """
        sample = _sample_between if between_cells else _sample
        return sample(self._field, *self._origin_xy, self._resolution_m, positions)


def _without_seen(grid: OccupancyGrid, seen: NDArray[np.float64]) -> OccupancyGrid:
    """The grid with its occupied cells free where a point (N, 2) lies in them or in a neighbour."""
    rows, cols = grid.shape
    at = grid.cells_of(seen)
    at = at[(at[:, 0] >= 0) & (at[:, 0] < rows) & (at[:, 1] >= 0) & (at[:, 1] < cols)]
    shown = np.zeros((rows, cols), dtype=np.uint8)
    shown[at[:, 0], at[:, 1]] = 1
    shown = cv2.dilate(shown, _NEIGHBOURS)
    is_shown = (grid.cells == OCCUPIED) & (shown > 0)
    return replace(grid, cells=np.where(is_shown, FREE, grid.cells).astype(np.int8))


@njit(cache=True)
def _sample(
    field: NDArray[np.float32], x0: float, y0: float, resolution: float, positions: NDArray[np.float64]
) -> NDArray[np.float64]:
    out = np.zeros(positions.shape[0])
    for i in range(positions.shape[0]):
        col = int(np.floor((positions[i, 0] - x0) / resolution))
        row = int(np.floor((positions[i, 1] - y0) / resolution))
        if 0 <= row < field.shape[0] and 0 <= col < field.shape[1]:
            out[i] = field[row, col]
    return out


@njit(cache=True)
def _sample_between(
    field: NDArray[np.float32], x0: float, y0: float, resolution: float, positions: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Bilinear between the centres of cells; beyond the field all is 0."""
    out = np.zeros(positions.shape[0])
    for i in range(positions.shape[0]):
        u = (positions[i, 0] - x0) / resolution - 0.5
        v = (positions[i, 1] - y0) / resolution - 0.5
        col, row = int(np.floor(u)), int(np.floor(v))
        for dr in range(2):
            for dc in range(2):
                r, c = row + dr, col + dc
                if 0 <= r < field.shape[0] and 0 <= c < field.shape[1]:
                    out[i] += field[r, c] * abs(1 - dr - (v - row)) * abs(1 - dc - (u - col))
    return out
