"""When each place of the map was first known: what lets the report's map grow again."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from explore_bt.types import UNKNOWN, OccupancyGrid

__all__ = ["FirstSeen"]


class FirstSeen:
    """Keeps one stamp per cell while grids grow and shift under it."""

    def __init__(self) -> None:
        self._stamps_s = np.full((0, 0), np.inf, dtype=np.float32)
        self._origin_xy = (0.0, 0.0)
        self._resolution_m = 0.0

    def note(self, stamp_s: float, grid: OccupancyGrid) -> None:
        """Give ``stamp_s`` to every known cell that has none yet."""
        if grid.origin_xy != self._origin_xy or grid.shape != self._stamps_s.shape:
            self._stamps_s = self.on(grid)
            self._origin_xy, self._resolution_m = grid.origin_xy, grid.resolution_m
        self._stamps_s[(grid.cells != UNKNOWN) & np.isinf(self._stamps_s)] = stamp_s

    def on(self, grid: OccupancyGrid) -> NDArray[np.float32]:
        """(rows, cols) float32 on the cells of ``grid``: seconds, +inf where nothing was known."""
        stamps = np.full(grid.shape, np.inf, dtype=np.float32)
        if self._resolution_m <= 0.0:
            return stamps
        rows, cols = (
            np.floor(
                (grid.origin_xy[axis] + (np.arange(count) + 0.5) * grid.resolution_m - self._origin_xy[axis])
                / self._resolution_m
            ).astype(np.int64)
            for axis, count in ((1, grid.shape[0]), (0, grid.shape[1]))
        )
        in_row = (rows >= 0) & (rows < self._stamps_s.shape[0])
        in_col = (cols >= 0) & (cols < self._stamps_s.shape[1])
        stamps[np.ix_(in_row, in_col)] = self._stamps_s[np.ix_(rows[in_row], cols[in_col])]
        return stamps
