"""A map pooled into coarse blocks that stay where they are when the map grows or is drawn finer."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray

from explore_bt.exploration.kernel_input import read_only
from explore_bt.exploration.windows import changed_window
from explore_bt.types import FREE, OCCUPIED, UNKNOWN, GridWindow, OccupancyGrid

__all__ = ["Blocks", "PooledMaps", "pooled_map"]


@dataclass(frozen=True, slots=True)
class Blocks:
    """Squares of ``side`` cells on a lattice through the map frame's origin.

    Attributes:
        side: cells along an edge, at least 1.
        shift: (rows, columns) of the first block that lie before the map's first cell.
        shape: rows and columns of blocks.
        first: the first block's place on the lattice.
    """

    side: int
    shift: tuple[int, int]
    shape: tuple[int, int]
    first: tuple[int, int]

    @staticmethod
    def over(grid: OccupancyGrid, side_m: float, chunk: int = 1) -> Blocks:
        """Blocks of about ``side_m``, a whole number of cells, over the map.

        Args:
            grid: the map.
            side_m: edge of a block, metres.
            chunk: begin and end at whole multiples of so many blocks; a map that grows cell by cell then
                seldom changes their number.
        """
        side = max(1, round(side_m / grid.resolution_m))
        col, row = (round(corner / grid.resolution_m) for corner in grid.origin_xy)
        step = side * chunk
        first = (row // step * chunk, col // step * chunk)
        shift = (row - first[0] * side, col - first[1] * side)
        rows, cols = (
            -(-(size + before) // step) * chunk for size, before in zip(grid.shape, shift, strict=True)
        )
        return Blocks(side, shift, (rows, cols), first)

    def of(self, cells: NDArray[np.integer]) -> NDArray[np.int64]:
        """(N, 2) rows and columns of the blocks that hold (N, 2) cells."""
        return (cells + np.asarray(self.shift)) // self.side

    def best_cells(self, score: NDArray[np.float32]) -> NDArray[np.int64]:
        """(rows, columns, 2) int64: in each block the cell with the highest score above zero, else -1."""
        return _best(read_only(score), self.side, self.shift[0], self.shift[1], self.shape[0], self.shape[1])


@njit(cache=True)
def _best(score, side, row0, col0, rows, cols):  # type: ignore[no-untyped-def]  # numba kernel
    best = np.full((rows, cols, 2), -1, dtype=np.int64)
    height = np.zeros((rows, cols), dtype=np.float32)
    for row in range(score.shape[0]):
        for col in range(score.shape[1]):
            r, c = (row + row0) // side, (col + col0) // side
            if score[row, col] > height[r, c]:
                height[r, c] = score[row, col]
                best[r, c, 0], best[r, c, 1] = row, col
    return best


@njit(cache=True)
def _pool(cells, side, row0, col0, rows, cols):  # type: ignore[no-untyped-def]  # numba kernel
    """A block is occupied if any cell is; else free if any is known."""
    pooled = np.full((rows, cols), UNKNOWN, dtype=np.int8)
    for row in range(cells.shape[0]):
        for col in range(cells.shape[1]):
            value = cells[row, col]
            r, c = (row + row0) // side, (col + col0) // side
            if value == OCCUPIED or (value == FREE and pooled[r, c] == UNKNOWN):
                pooled[r, c] = value
    return pooled


def pooled_map(grid: OccupancyGrid, blocks: Blocks) -> NDArray[np.int8]:
    """(rows, columns) int8 of blocks: ``OCCUPIED``, ``FREE`` or ``UNKNOWN``."""
    row0, col0 = blocks.shift
    return _pool(read_only(grid.cells), blocks.side, row0, col0, blocks.shape[0], blocks.shape[1])


class PooledMaps:
    """Pooled maps of the states of a map, at a cost that follows what has changed since the last one."""

    def __init__(self) -> None:
        self._last: tuple[OccupancyGrid, Blocks, NDArray[np.int8]] | None = None

    def of(self, grid: OccupancyGrid, blocks: Blocks) -> NDArray[np.int8]:
        """The same as ``pooled_map(grid, blocks)``."""
        if self._last is None or self._last[1] != blocks or self._last[0].shape != grid.shape:
            pooled = pooled_map(grid, blocks)
        else:
            pooled = _pooled_later(*self._last, grid)
        self._last = (grid, blocks, pooled)
        return pooled


def _pooled_later(
    before: OccupancyGrid, blocks: Blocks, pooled: NDArray[np.int8], grid: OccupancyGrid
) -> NDArray[np.int8]:
    window = changed_window(before.cells != grid.cells)
    if window.is_empty:
        return pooled
    side, (row0, col0) = blocks.side, blocks.shift
    at = GridWindow(
        (window.row0 + row0) // side,
        (window.col0 + col0) // side,
        (window.row1 - 1 + row0) // side + 1,
        (window.col1 - 1 + col0) // side + 1,
    )
    first = (max(0, at.row0 * side - row0), max(0, at.col0 * side - col0))
    cells = grid.cells[first[0] : at.row1 * side - row0, first[1] : at.col1 * side - col0]
    shift = (row0 + first[0] - at.row0 * side, col0 + first[1] - at.col0 * side)
    pooled = pooled.copy()
    pooled[at.slices] = _pool(read_only(cells), side, *shift, at.row1 - at.row0, at.col1 - at.col0)
    return pooled
