"""A small map that makes every kernel compile before the robot drives."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from explore_bt.types import OCCUPIED, UNKNOWN, OccupancyGrid, Pose2

__all__ = ["later_states", "practice_grid"]


def practice_grid(threshold_m: float) -> tuple[OccupancyGrid, Pose2, Pose2]:
    """Two rooms, a doorway between them, a start in one and a goal in the other."""
    resolution_m = max(threshold_m, 0.05) / 5.0
    cells = np.zeros((60, 80), dtype=np.int8)
    cells[:, 38:42] = OCCUPIED
    cells[40:56, 38:42] = 0
    grid = OccupancyGrid(cells, resolution_m, (0.0, 0.0))
    start, goal = grid.center_of(10, 10), grid.center_of(10, 68)
    return grid, Pose2(*start, 0.0), Pose2(*goal, 0.0)


def later_states(grid: OccupancyGrid) -> tuple[OccupancyGrid, OccupancyGrid]:
    """The practice map with an obstacle more, and then grown by a few cells."""
    cells = grid.cells.copy()
    cells[-3, 3] = OCCUPIED
    changed = replace(grid, cells=cells, revision=grid.revision + 1)
    wider = np.pad(cells, ((0, 4), (0, 4)), constant_values=UNKNOWN)
    return changed, replace(changed, cells=wider, revision=grid.revision + 2)
