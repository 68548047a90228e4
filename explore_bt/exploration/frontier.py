"""Frontiers: where known free floor meets the unknown (Yamauchi, 1997)."""

from __future__ import annotations

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
    if count == 0:
        return ()
    cells = np.column_stack(np.nonzero(labels))
    label = labels[cells[:, 0], cells[:, 1]]
    order = np.argsort(label, kind="stable")
    cells, starts = cells[order], np.searchsorted(label[order], np.arange(1, count + 1))
    extent = np.maximum.reduceat(cells, starts) - np.minimum.reduceat(cells, starts)
    sizes_m = (1.0 + np.hypot(extent[:, 0], extent[:, 1])) * grid.resolution_m
    frontiers = [
        _frontier(grid, cluster, float(size_m))
        for cluster, size_m in zip(np.split(cells, starts[1:]), sizes_m, strict=True)
        if size_m >= min_size_m
    ]
    return tuple(sorted(frontiers, key=lambda frontier: tuple(frontier.cells[0].tolist())))


def _frontier(grid: OccupancyGrid, cells: NDArray[np.int64], size_m: float) -> Frontier:
    middle = cells.mean(axis=0)
    x, y = grid.centers_of(middle[None])[0].tolist()
    row, col = cells[int(np.argmin(((cells - middle) ** 2).sum(axis=1)))].tolist()
    return Frontier(cells=cells, centroid=(x, y), middle_cell=(row, col), size_m=size_m)
