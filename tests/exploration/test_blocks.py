from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from explore_bt.exploration.blocks import Blocks, pooled_map
from explore_bt.types import FREE, OCCUPIED, UNKNOWN, OccupancyGrid
from tests.exploration.grids import random_cells


@settings(deadline=None)  # compiles
@given(random_cells(), st.integers(0, 3), st.integers(0, 3))
def test_blocks_stay_where_they_are_when_the_map_grows(cells: np.ndarray, below: int, left: int) -> None:
    small = OccupancyGrid(cells, 0.1, (0.0, 0.0))
    grown_cells = np.pad(cells, ((below, 2), (left, 1)), constant_values=UNKNOWN)
    grown = OccupancyGrid(grown_cells, 0.1, (-0.1 * left, -0.1 * below))
    places = []
    for grid in (small, grown):
        best = Blocks.over(grid, 0.2).best_cells(grid.free.astype(np.float32))
        places.append(grid.centers_of(best[best[..., 0] >= 0]))
    assert np.allclose(*places)


@settings(deadline=None)  # compiles
@given(random_cells())
def test_a_finer_map_of_the_same_looks_the_same_in_blocks(cells: np.ndarray) -> None:
    coarse = OccupancyGrid(cells, 0.1, (0.3, -0.2))
    fine = OccupancyGrid(np.kron(cells, np.ones((2, 2), dtype=np.int8)), 0.05, (0.3, -0.2))
    maps = [pooled_map(grid, Blocks.over(grid, 0.1)) for grid in (coarse, fine)]
    assert np.array_equal(*maps)


def test_a_block_with_any_obstacle_is_occupied_and_else_one_with_any_floor_is_free() -> None:
    cells = np.full((2, 6), UNKNOWN, dtype=np.int8)
    cells[0, :4] = FREE
    cells[1, 1] = OCCUPIED
    grid = OccupancyGrid(cells, 0.05, (0.0, 0.0))
    assert pooled_map(grid, Blocks.over(grid, 0.1)).tolist() == [[OCCUPIED, FREE, UNKNOWN]]
