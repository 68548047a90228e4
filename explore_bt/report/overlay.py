"""Several robots' maps in one picture."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from explore_bt.types import FREE, OCCUPIED, UNKNOWN, OccupancyGrid

__all__ = ["cropped", "overlaid"]


def overlaid(grids: Sequence[OccupancyGrid]) -> OccupancyGrid:
    """The union of maps that share the ``map`` frame, in the resolution of the first.

    What any robot has seen is known; where they disagree there is an obstacle.
    """
    if len(grids) == 1:
        return grids[0]
    size = grids[0].resolution_m
    low = np.min([grid.origin_xy for grid in grids], axis=0)
    high = np.max([_upper(grid) for grid in grids], axis=0)
    cols, rows = np.ceil((high - low) / size - 1e-6).astype(int)
    union = OccupancyGrid(np.full((rows, cols), UNKNOWN, dtype=np.int8), size, (float(low[0]), float(low[1])))
    cells = np.full((rows, cols), UNKNOWN, dtype=np.int8)
    for value in (FREE, OCCUPIED):
        for grid in grids:
            found = union.cells_of(grid.centers_of(np.argwhere(grid.cells == value)))
            cells[found[:, 0].clip(0, rows - 1), found[:, 1].clip(0, cols - 1)] = value
    return OccupancyGrid(cells, size, union.origin_xy)


def _upper(grid: OccupancyGrid) -> tuple[float, float]:
    rows, cols = grid.shape
    return (grid.origin_xy[0] + cols * grid.resolution_m, grid.origin_xy[1] + rows * grid.resolution_m)


def cropped(grid: OccupancyGrid, margin_m: float = 0.3) -> OccupancyGrid:
    """The known part of a map with a margin around it; one unknown cell if nothing is known."""
    known = grid.cells != UNKNOWN
    rows, cols = np.flatnonzero(known.any(axis=1)), np.flatnonzero(known.any(axis=0))
    if not len(rows):
        return OccupancyGrid(np.full((1, 1), UNKNOWN, dtype=np.int8), grid.resolution_m, grid.origin_xy)
    margin = round(margin_m / grid.resolution_m)
    row0, col0 = int(rows[0]) - margin, int(cols[0]) - margin
    shape = (int(rows[-1]) + 1 + margin - row0, int(cols[-1]) + 1 + margin - col0)
    cells = np.full(shape, UNKNOWN, dtype=np.int8)
    inner = known[rows[0] : rows[-1] + 1, cols[0] : cols[-1] + 1].shape
    cells[margin : margin + inner[0], margin : margin + inner[1]] = grid.cells[
        rows[0] : rows[-1] + 1, cols[0] : cols[-1] + 1
    ]
    corner = (grid.origin_xy[0] + col0 * grid.resolution_m, grid.origin_xy[1] + row0 * grid.resolution_m)
    return OccupancyGrid(cells, grid.resolution_m, corner)
