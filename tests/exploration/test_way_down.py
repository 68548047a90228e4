import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from explore_bt.exploration import clearance_field, travel_field
from explore_bt.exploration.way_down import way_down
from explore_bt.types import FREE, OccupancyGrid

from .grids import random_cells


@settings(deadline=None, max_examples=80)
@given(random_cells(weights="...#"), st.integers(0, 2**32 - 1))
def test_the_way_down_is_as_long_as_the_field_says(cells, seed):
    free = np.argwhere(cells == FREE)
    if len(free) == 0:
        return
    start = free[np.random.default_rng(seed).integers(len(free))]
    field = travel_field(clearance_field(OccupancyGrid(cells, 0.1, (0.0, 0.0))), start, 0.0, 0.1)
    for cell in np.argwhere(np.isfinite(field)).tolist():
        way = way_down(field, tuple(cell))
        assert way[0].tolist() == start.tolist()
        assert way[-1].tolist() == cell
        steps = np.abs(np.diff(way, axis=0))
        assert (steps.max(axis=1) == 1).all() if len(steps) else True
        assert 0.1 * np.hypot(*steps.T).sum() == pytest.approx(field[tuple(cell)], abs=1e-4)
