"""Compilation of every kernel ahead of time."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from explore_bt.exploration.clearance import clearance_field
from explore_bt.exploration.gain import visible_unknown_area
from explore_bt.exploration.grid_scan import scan_of_grid
from explore_bt.exploration.ground import Ground
from explore_bt.exploration.outlook import Outlooks
from explore_bt.exploration.reach import Reach
from explore_bt.exploration.remains import what_remains
from explore_bt.exploration.travel import travel_field
from explore_bt.exploration.view_places import ViewPlaces
from explore_bt.exploration.view_tour import TourTaste, choose_views, order_views
from explore_bt.types import FREE, OCCUPIED, UNKNOWN, OccupancyGrid, Pose2

__all__ = ["warm_up"]


def warm_up() -> None:
    """Compile all kernels, or load them from numba's cache; call at set-up, never while driving.

    It solves a small map: a room with an opening to the unknown, and one behind a gap too narrow.
    """
    cells = np.full((24, 40), UNKNOWN, dtype=np.int8)
    cells[2:22, 2:38] = FREE
    cells[:, 20] = OCCUPIED
    cells[11, 20] = FREE
    grid = OccupancyGrid(cells, 0.1, (0.0, 0.0))
    clearance_m = clearance_field(grid)
    for weight in (0.0, 1.0):
        travel_m = travel_field(clearance_m, (12, 10), 0.2, grid.resolution_m, clearance_weight=weight)
    visible_unknown_area(grid, (1.0, 1.0), 1.2)
    scan_of_grid(grid, Pose2(1.0, 1.0, 0.0), 1.2)
    cells = cells.copy()
    cells[2:22, 2] = UNKNOWN
    outlooks = Outlooks()
    for state in (grid, replace(grid, cells=cells)):  # the second time it looks where the map has changed
        places = ViewPlaces(Reach(Ground(state), clearance_m, (1.0, 1.0), 0.2))
        chosen = choose_views(places, outlooks, 1.2, TourTaste())
    order_views(chosen, lambda _: 0.0, TourTaste())
    what_remains(grid, clearance_m, travel_m, 0.2)
