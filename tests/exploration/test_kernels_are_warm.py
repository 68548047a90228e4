import math

import numpy as np

from explore_bt.exploration import (
    clearance_field,
    escape,
    find_frontiers,
    gain,
    passage,
    places,
    sight,
    travel,
    travel_field,
    visible_unknown_area,
    warm_up,
)
from explore_bt.types import FREE, UNKNOWN, OccupancyGrid

KERNELS = (
    escape._climb,
    gain._see_from_each,
    passage._flood,
    places._best_per_block,
    sight._look,
    travel._spread,
)


def test_after_warm_up_nothing_is_left_to_compile():
    warm_up()
    compiled = [len(kernel.signatures) for kernel in KERNELS]
    assert all(count > 0 for count in compiled)
    rng = np.random.default_rng(0)
    wide = rng.choice([FREE, FREE, UNKNOWN], (60, 80)).astype(np.int8)
    for cells in (wide.copy(), wide[::2, ::2], np.asfortranarray(wide)):
        grid = OccupancyGrid(cells, 0.05, (0.0, 0.0))
        clearance = clearance_field(grid)
        clearance.flags.writeable = False
        travel_field(clearance, np.array([(3, 3), (9, 9)], dtype=np.int32), 0.01, 0.05, clearance_weight=0.5)
        visible_unknown_area(grid, (1, 1), 1.0, math.pi, 0)
        find_frontiers(grid)
    assert [len(kernel.signatures) for kernel in KERNELS] == compiled
