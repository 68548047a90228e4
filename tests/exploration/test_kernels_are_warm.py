import math

import numpy as np

from explore_bt.exploration import (
    Ground,
    Outlooks,
    Reach,
    TourTaste,
    ViewPlaces,
    blocks,
    choose_views,
    clearance_field,
    escape,
    find_frontiers,
    gain,
    outlook,
    passage,
    tour,
    travel,
    travel_field,
    visible_unknown_area,
    warm_up,
)
from explore_bt.types import FREE, UNKNOWN, OccupancyGrid

KERNELS = (
    blocks._best,
    blocks._pool,
    escape._climb,
    gain._see_from_each,
    outlook._changed_tiles,
    outlook._cones,
    outlook._frontier_blocks,
    outlook._look,
    outlook._may_meet,
    outlook._rays,
    outlook._within,
    passage._flood,
    tour._improve,
    travel._flood,
    travel._spread,
)


def test_after_warm_up_nothing_is_left_to_compile():
    warm_up()
    compiled = [len(kernel.signatures) for kernel in KERNELS]
    assert all(count > 0 for count in compiled)
    rng = np.random.default_rng(0)
    wide = rng.choice([FREE, FREE, UNKNOWN], (60, 80)).astype(np.int8)
    later, last = wide.copy(), wide.copy()
    later[:20] = last[:20] = FREE
    later[32:40, 40:48], last[32:40, 40:48] = FREE, UNKNOWN  # one tile of blocks
    outlooks = Outlooks()
    for cells in (wide.copy(), later, last, wide[::2, ::2], np.asfortranarray(wide)):
        grid = OccupancyGrid(cells, 0.05, (0.0, 0.0))
        clearance = clearance_field(grid)
        clearance.flags.writeable = False
        at = np.array([(3, 3), (9, 9)], dtype=np.int32)
        travel_field(clearance, at, 0.01, 0.05, clearance_weight=0.5)
        visible_unknown_area(grid, (1, 1), 1.0, math.pi, 0)
        find_frontiers(grid)
        places = ViewPlaces(Reach(Ground(grid), clearance, (0.2, 0.2), 0.01))
        choose_views(places, outlooks, 1.0, TourTaste())
    assert [len(kernel.signatures) for kernel in KERNELS] == compiled
