"""Occupancy grids of others, and what has changed in them."""

from __future__ import annotations

import math
from collections import deque
from dataclasses import replace
from typing import Any

import numpy as np

from explore_bt.types import FREE, OCCUPIED, UNKNOWN, GridWindow, OccupancyGrid, Pose2

__all__ = ["GridHistory", "grid_message", "grid_of", "nothing_known"]

_FREE_UP_TO, _OCCUPIED_FROM = 25, 65
"""Thresholds of map_server and Nav2, percent."""
_MEMORY = 100
_START_M = 1.0
_RESOLUTION_M = 0.05


def grid_of(message: Any, pose: Pose2, radius_m: float) -> OccupancyGrid:
    """A ``nav_msgs/OccupancyGrid``; what is unknown under the robot itself is free.

    Args:
        message: as it came.
        pose: of the robot, ``map`` frame.
        radius_m: of its footprint.

    Raises:
        ValueError: in words, what is wrong with it.
    """
    info = message.info
    rows, cols, resolution_m = int(info.height), int(info.width), float(info.resolution)
    values = np.asarray(message.data, dtype=np.int8)
    if (
        not (resolution_m > 0.0 and math.isfinite(resolution_m))
        or rows * cols != len(values)
        or not len(values)
    ):
        raise ValueError(f"{len(values)} cells for {rows} × {cols} of {resolution_m:g} m")
    turn = info.origin.orientation
    if abs(turn.z) > 1e-3 or abs(turn.x) > 1e-3 or abs(turn.y) > 1e-3:
        raise ValueError("its origin is turned; expected a map along the axes of its frame")
    values = values.reshape(rows, cols)
    cells = np.full((rows, cols), UNKNOWN, dtype=np.int8)
    cells[(values >= 0) & (values <= _FREE_UP_TO)] = FREE
    cells[values >= _OCCUPIED_FROM] = OCCUPIED
    grid = OccupancyGrid(cells, resolution_m, (float(info.origin.position.x), float(info.origin.position.y)))
    return _standing(grid, pose, radius_m)


def grid_message(message: Any, grid: OccupancyGrid) -> Any:
    """Fill a ``nav_msgs/OccupancyGrid``; its header is the caller's."""
    import array

    message.info.resolution = grid.resolution_m
    message.info.height, message.info.width = grid.shape
    message.info.origin.position.x, message.info.origin.position.y = (float(each) for each in grid.origin_xy)
    message.info.origin.orientation.w = 1.0
    message.data = array.array("b", grid.cells.tobytes())
    return message


def nothing_known(pose: Pose2) -> OccupancyGrid:
    """An unknown square of 2 m about the robot."""
    cells = round(2.0 * _START_M / _RESOLUTION_M)
    origin = (pose.x - _START_M, pose.y - _START_M)
    return OccupancyGrid(np.full((cells, cells), UNKNOWN, dtype=np.int8), _RESOLUTION_M, origin)


class GridHistory:
    """The newest grid, and which cells the last ones changed.

    Args:
        grid: the first.
    """

    def __init__(self, grid: OccupancyGrid) -> None:
        self.grid = grid
        self._windows: deque[tuple[int, GridWindow | None]] = deque(maxlen=_MEMORY)

    def add(self, grid: OccupancyGrid) -> None:
        """A newer one; the same cells again are no news."""
        before = self.grid
        window: GridWindow | None = None
        if _same_frame(before, grid):
            window = _changed(before, grid)
            if window.is_empty:
                return
        self.grid = replace(grid, revision=before.revision + 1)
        self._windows.append((self.grid.revision, window))

    def changed_since(self, revision: int) -> GridWindow | None:
        """See ``Slam.changed_since``."""
        if revision == self.grid.revision:
            return GridWindow(0, 0, 0, 0)
        later = [window for number, window in self._windows if number > revision]
        if revision > self.grid.revision or len(later) != self.grid.revision - revision:
            return None
        whole = GridWindow(0, 0, 0, 0)
        for window in later:
            if window is None:
                return None
            whole = whole.joined(window)
        return whole


def _standing(grid: OccupancyGrid, pose: Pose2, radius_m: float) -> OccupancyGrid:
    unknown = np.argwhere(grid.unknown)
    if not len(unknown):
        return grid
    centres = grid.centers_of(unknown)
    under = unknown[np.hypot(centres[:, 0] - pose.x, centres[:, 1] - pose.y) <= radius_m]
    if not len(under):
        return grid
    cells = grid.cells.copy()
    cells[under[:, 0], under[:, 1]] = FREE
    return replace(grid, cells=cells)


def _same_frame(one: OccupancyGrid, other: OccupancyGrid) -> bool:
    return (one.shape, one.resolution_m, one.origin_xy) == (other.shape, other.resolution_m, other.origin_xy)


def _changed(before: OccupancyGrid, after: OccupancyGrid) -> GridWindow:
    differ = before.cells != after.cells
    rows, cols = np.flatnonzero(differ.any(axis=1)), np.flatnonzero(differ.any(axis=0))
    if not len(rows):
        return GridWindow(0, 0, 0, 0)
    return GridWindow(int(rows[0]), int(cols[0]), int(rows[-1]) + 1, int(cols[-1]) + 1)
