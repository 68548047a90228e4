"""The map as decisions see it: in blocks of 10 cm, alike for a map and for a finer drawing of it."""

from __future__ import annotations

from functools import cached_property

import cv2
import numpy as np
from numpy.typing import NDArray

from explore_bt.exploration.blocks import Blocks, PooledMaps
from explore_bt.exploration.clearance import Clearances
from explore_bt.types import FREE, OCCUPIED, UNKNOWN, OccupancyGrid

__all__ = ["BLOCK_M", "Ground", "GroundMemory"]

BLOCK_M = 0.1
"""Side of a block; of a coarser map, a block is a cell."""
_CHUNK = 64
_TIE = 1e-6


class GroundMemory:
    """What makes the ground of the next state of a map cheap."""

    def __init__(self) -> None:
        self.pooled_maps, self.corner_clearances = PooledMaps(), Clearances()


class Ground:
    """A map in blocks, on a lattice through the map frame's origin, to the nearest cell.

    Attributes:
        source: the map itself.
        blocks: which of its cells lie in which block.
        grid: the blocks as a map: occupied if a cell is; else free if one is.
    """

    def __init__(self, source: OccupancyGrid, memory: GroundMemory | None = None) -> None:
        """See a map so; the memory that was given with its earlier states makes that cheaper."""
        self.source = source
        self.blocks = Blocks.over(source, BLOCK_M, _CHUNK)
        (row, col), (x, y), cell_m = self.blocks.shift, source.origin_xy, source.resolution_m
        self._memory = memory or GroundMemory()
        pooled = self._memory.pooled_maps.of(source, self.blocks)
        self.grid = OccupancyGrid(pooled, self.blocks.side * cell_m, (x - col * cell_m, y - row * cell_m))
        self._without_specks: dict[float, NDArray[np.int8]] = {}

    @cached_property
    def room_m(self) -> NDArray[np.float32]:
        """(rows, columns) float32, metres from each block's middle to the edge of what is not free."""
        corners = self._corners()
        clearance_m = self._memory.corner_clearances.of(corners)
        room = np.zeros(self.grid.shape, dtype=np.float32)
        fineness = self._fineness
        step, half_m = fineness * self.blocks.side, np.float32(0.5 * corners.resolution_m)
        rows, cols = (
            np.arange(count) * step + step // 2 - before * fineness
            for count, before in zip(self.grid.shape, self.blocks.shift, strict=True)
        )
        inner_rows, inner_cols = (
            (at >= 0) & (at < size) for at, size in zip((rows, cols), corners.shape, strict=True)
        )
        at_middles = clearance_m[np.ix_(rows[inner_rows], cols[inner_cols])]
        room[np.ix_(inner_rows, inner_cols)] = at_middles + (at_middles > 0.0) * half_m
        return room

    def block_of(self, points: NDArray[np.float64]) -> NDArray[np.int64]:
        """(N, 2) rows and columns of the blocks of (N, 2) points x, y; of two, the later one."""
        scaled = (points - np.asarray(self.grid.origin_xy)) / self.grid.resolution_m
        return np.floor(scaled[:, ::-1] + _TIE).astype(np.int64)

    def without_specks(self, least_m2: float) -> NDArray[np.int8]:
        """The blocks, with unknown patches of less area (joined by edges, not at the map's edge) free."""
        if least_m2 not in self._without_specks:
            cells = self.grid.cells
            unknown = np.ascontiguousarray(np.pad(cells == UNKNOWN, 1, constant_values=True)).view(np.uint8)
            _, labels, stats, _ = cv2.connectedComponentsWithStats(unknown, connectivity=4)
            is_speck = stats[:, cv2.CC_STAT_AREA] < least_m2 / self.grid.resolution_m**2
            is_speck[0] = False
            self._without_specks[least_m2] = np.where(is_speck[labels[1:-1, 1:-1]], np.int8(FREE), cells)
        return self._without_specks[least_m2]

    @property
    def _fineness(self) -> int:
        """Into how many a cell's side is cut, so that the middle of a block is a corner of four parts."""
        return 1 + self.blocks.side % 2

    def _corners(self) -> OccupancyGrid:
        """The corners of the cells, or of their quarters, as a map: occupied if one of its four is not free.

        The point of a cell that is nearest to a corner is a corner, so their distances are exact.
        """
        free = np.pad(self.source.free.repeat(self._fineness, 0).repeat(self._fineness, 1), 1)
        free = free[1:, :] & free[:-1, :]
        free = free[:, 1:] & free[:, :-1]
        cells = np.where(free, np.int8(FREE), np.int8(OCCUPIED))
        return OccupancyGrid(cells, self.source.resolution_m / self._fineness, self.source.origin_xy)
