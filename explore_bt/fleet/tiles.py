"""A robot's own map cut into tiles, of which only those that have changed are told."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from explore_bt.fleet.messages import Tile
from explore_bt.types import UNKNOWN, GridWindow, OccupancyGrid

__all__ = ["TILE_CELLS", "TileCutter", "cut_tile", "first_cell"]

TILE_CELLS = 64
"""Cells along a tile's side: 3.2 m at 5 cm."""


def first_cell(grid: OccupancyGrid) -> tuple[int, int]:
    """Column and row of a map's first cell on the lattice through the origin of its frame."""
    x, y = grid.origin_xy
    return (round(x / grid.resolution_m), round(y / grid.resolution_m))


class TileCutter:
    """Remembers what was cut before."""

    def __init__(self) -> None:
        self._cut: dict[tuple[int, int], bytes] = {}

    def changed(self, grid: OccupancyGrid, window: GridWindow | None, revision: int) -> Iterator[Tile]:
        """The tiles that differ from when they were last cut; a tile that is all unknown is none.

        Args:
            grid: the robot's own map.
            window: only there anything may have changed; None: anywhere.
            revision: of the tiles.
        """
        col0, row0 = first_cell(grid)
        part = window or GridWindow(0, 0, *grid.shape)
        if part.is_empty:
            return
        for row in range((part.row0 + row0) // TILE_CELLS, (part.row1 - 1 + row0) // TILE_CELLS + 1):
            for col in range((part.col0 + col0) // TILE_CELLS, (part.col1 - 1 + col0) // TILE_CELLS + 1):
                tile = Tile(revision, grid.resolution_m, (col, row), cut_tile(grid, (col, row), (col0, row0)))
                content = tile.cells.tobytes()
                was = self._cut.get((col, row))
                if content == was or (was is None and (tile.cells == UNKNOWN).all()):
                    continue
                self._cut[col, row] = content
                yield tile


def cut_tile(grid: OccupancyGrid, place: tuple[int, int], first: tuple[int, int]) -> NDArray[np.int8]:
    """(TILE_CELLS, TILE_CELLS) int8: a tile of a map whose ``first_cell`` is given; unknown beyond it."""
    cells = np.full((TILE_CELLS, TILE_CELLS), UNKNOWN, dtype=np.int8)
    row, col = place[1] * TILE_CELLS - first[1], place[0] * TILE_CELLS - first[0]
    top, left = max(row, 0), max(col, 0)
    bottom, right = min(row + TILE_CELLS, grid.shape[0]), min(col + TILE_CELLS, grid.shape[1])
    if top < bottom and left < right:
        cells[top - row : bottom - row, left - col : right - col] = grid.cells[top:bottom, left:right]
    cells.flags.writeable = False
    return cells
