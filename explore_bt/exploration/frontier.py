"""Frontiers: where known free floor meets the unknown (Yamauchi, 1997)."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from explore_bt.types import OccupancyGrid

__all__ = ["Frontier", "find_frontiers", "frontier_mask"]

_EIGHT = np.ones((3, 3), dtype=np.int8)


@dataclass(frozen=True, slots=True, eq=False)
class Frontier:
    """One 8-connected cluster of frontier cells.

    Attributes:
        cells: (N, 2) int64 rows and columns, row by row.
        centroid: mean of the cells' centres, metres, ``map`` frame; may lie off the frontier.
        middle_cell: (row, column) of the frontier's cell nearest to the centroid.
        size_m: extent from corner to corner, metres: for a straight frontier its length.
    """

    cells: NDArray[np.int64]
    centroid: tuple[float, float]
    middle_cell: tuple[int, int]
    size_m: float


def frontier_mask(grid: OccupancyGrid, *, off_walls: bool = False) -> NDArray[np.bool_]:
    """(rows, cols) bool: free cells with an unknown 4-neighbour; the world outside the grid is unknown.

    Args:
        grid: the map.
        off_walls: leave out cells that touch an occupied one (8 neighbours), where noise in the map
            leaves cells unknown that nothing will ever show.
    """
    unknown = np.pad(grid.unknown, 1, constant_values=True)
    beside = unknown[:-2, 1:-1] | unknown[2:, 1:-1] | unknown[1:-1, :-2] | unknown[1:-1, 2:]
    mask = grid.free & beside
    return mask & ~ndimage.binary_dilation(grid.occupied, _EIGHT) if off_walls else mask


def find_frontiers(
    grid: OccupancyGrid, min_size_m: float = 0.0, *, off_walls: bool = False
) -> tuple[Frontier, ...]:
    """The frontiers of at least a given extent, in the order of their first cells, row by row.

    Args:
        grid: the map.
        min_size_m: smaller clusters are leaks between beams, not openings.
        off_walls: as for :func:`frontier_mask`.
    """
    labels, count = ndimage.label(frontier_mask(grid, off_walls=off_walls), _EIGHT)
    rows, cols = np.nonzero(labels)
    label = labels[rows, cols]
    order = np.argsort(label, kind="stable")
    cells = np.column_stack((rows, cols))[order]
    clusters = np.split(cells, np.searchsorted(label[order], np.arange(2, count + 1))) if count else []
    frontiers = sorted(
        (_frontier(grid, cluster) for cluster in clusters), key=lambda f: tuple(f.cells[0].tolist())
    )
    return tuple(frontier for frontier in frontiers if frontier.size_m >= min_size_m)


def _frontier(grid: OccupancyGrid, cells: NDArray[np.int64]) -> Frontier:
    extent = cells.max(axis=0) - cells.min(axis=0)
    middle = cells.mean(axis=0)
    row, col = cells[int(np.argmin(((cells - middle) ** 2).sum(axis=1)))].tolist()
    return Frontier(
        cells=cells,
        centroid=grid.center_of(float(middle[0]), float(middle[1])),  # type: ignore[arg-type]  # a mean cell is fractional
        middle_cell=(row, col),
        size_m=(1.0 + math.hypot(*extent.tolist())) * grid.resolution_m,
    )
