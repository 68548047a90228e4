"""The paper's mathematics: pure functions over frozen values, no tree and no plugin in sight.

One decision takes the steps of ALGORITHM.md in this order::

    Scan2D ──► find_free_sectors ──► order_by_safety       1, 2   q_1 … q_n, the safest first
                     │
                     ▼  for each q_i
               next_waypoint                               3      p^{k+1} = p^k + d̃ (cos θ, sin θ)
                     │
                     ▼
               HalfPlaneHistory.contains                   4      p^{k+1} in H_{k−L+1}^k
                     │
                     ▼
               is_allowed (why not: repeated_visit)        5      new place, or new direction
                     │
                     ▼
               visible_unknown_area                        6      it can show new area
                     │
                     ├── yes ──► drive there; HalfPlaneHistory.push
                     └── none ─► HalfPlaneHistory.reset, again; then facing_rad = π with a^r = 1     7

What the paper leaves open is answered on the map::

    OccupancyGrid ──► Ground ──► Reach ──► ViewPlaces ──► choose_views ──► order_views ──► first_run
          └─────────► find_frontiers ──► what_remains, once nothing is left to be seen

``CoverageMeter`` and ``ate_rmse_m`` measure a run against the truth. ``warm_up`` compiles the kernels.
"""

from explore_bt.exploration.alignment import align_se2, ate_rmse_m
from explore_bt.exploration.arguments import ArgumentError
from explore_bt.exploration.clearance import Clearances, clearance_at, clearance_field
from explore_bt.exploration.compilation import warm_up
from explore_bt.exploration.coverage import CoverageMeter
from explore_bt.exploration.free_sectors import FreeSector, find_free_sectors, order_by_safety
from explore_bt.exploration.frontier import Frontier, find_frontiers, frontier_mask
from explore_bt.exploration.gain import gain_many, visible_unknown_area
from explore_bt.exploration.grid_scan import scan_of_grid
from explore_bt.exploration.ground import Ground
from explore_bt.exploration.half_plane import HalfPlane, HalfPlaneHistory
from explore_bt.exploration.outlook import Outlooks
from explore_bt.exploration.passage import passage_field
from explore_bt.exploration.reach import Reach
from explore_bt.exploration.refuge import find_refuge, gap_to_courses_m
from explore_bt.exploration.remains import sentences, what_remains
from explore_bt.exploration.retrace import way_back
from explore_bt.exploration.revisit import is_allowed, repeated_visit
from explore_bt.exploration.sidestep import find_sidestep
from explore_bt.exploration.tour import open_tour
from explore_bt.exploration.travel import Travel, nearest_reaching_cell, travel_field, way_lengths
from explore_bt.exploration.view_places import ViewPlaces
from explore_bt.exploration.view_tour import TourTaste, View, ViewSet, choose_views, first_run, order_views
from explore_bt.exploration.waypoint import next_waypoint

__all__ = [
    "ArgumentError",
    "Clearances",
    "CoverageMeter",
    "FreeSector",
    "Frontier",
    "Ground",
    "HalfPlane",
    "HalfPlaneHistory",
    "Outlooks",
    "Reach",
    "TourTaste",
    "Travel",
    "View",
    "ViewPlaces",
    "ViewSet",
    "align_se2",
    "ate_rmse_m",
    "choose_views",
    "clearance_at",
    "clearance_field",
    "find_free_sectors",
    "find_frontiers",
    "find_refuge",
    "find_sidestep",
    "first_run",
    "frontier_mask",
    "gain_many",
    "gap_to_courses_m",
    "is_allowed",
    "nearest_reaching_cell",
    "next_waypoint",
    "open_tour",
    "order_by_safety",
    "order_views",
    "passage_field",
    "repeated_visit",
    "scan_of_grid",
    "sentences",
    "travel_field",
    "visible_unknown_area",
    "warm_up",
    "way_back",
    "way_lengths",
    "what_remains",
]
