import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from explore_bt.exploration import Clearances, clearance_at, clearance_field
from explore_bt.types import FREE, OCCUPIED, UNKNOWN, OccupancyGrid

from .grids import random_cells


def by_hand(cells, resolution_m):
    """Distance to every cell that is not free, the ring outside the grid included."""
    padded = np.pad(cells, 1, constant_values=-1)
    solid = np.argwhere(padded != FREE)
    field = np.zeros(cells.shape)
    for row, col in np.argwhere(cells == FREE):
        nearest = min(math.dist((row + 1, col + 1), cell) for cell in solid)
        field[row, col] = max(nearest - 0.5, 0.0) * resolution_m
    return field


@settings(deadline=None, max_examples=40)
@given(random_cells(12, ".....#?"))
def test_clearance_is_the_distance_to_the_nearest_cell_that_is_not_free(cells):
    field = clearance_field(OccupancyGrid(cells, 0.1, (0.0, 0.0)))
    np.testing.assert_allclose(field, by_hand(cells, 0.1), atol=1e-6)


@settings(deadline=None, max_examples=40)
@given(
    random_cells(20, ".........#?"),
    st.lists(st.tuples(st.floats(-0.5, 2.5), st.floats(-0.5, 2.5)), min_size=1, max_size=4),
    st.sampled_from([0.1, 0.25, 0.6]),
)
def test_clearance_at_points_agrees_with_the_field_up_to_its_reach(cells, points, reach_m):
    grid = OccupancyGrid(cells, 0.1, (0.0, 0.0))
    field = clearance_field(grid)
    for found, (x, y) in zip(clearance_at(grid, np.array(points), reach_m), points, strict=True):
        row, col = grid.cell_of(x, y)
        expected = field[row, col] if grid.contains_cell(row, col) else 0.0
        if expected < reach_m:
            assert found == pytest.approx(expected, abs=1e-6)
        else:
            assert found >= reach_m - 1e-6


@settings(deadline=None, max_examples=60)
@given(st.integers(0, 10_000), st.floats(0.0, 0.01), st.integers(1, 60))
def test_the_field_of_a_later_state_is_the_same_bits_as_a_new_one(seed, solid, size):
    rng = np.random.default_rng(seed)
    cells = np.where(rng.random((150, 190)) < solid, OCCUPIED, FREE).astype(np.int8)
    cells[:, rng.integers(0, 190) :] = UNKNOWN
    before = OccupancyGrid(cells, 0.05, (0.0, 0.0))
    clearances = Clearances()
    clearances.of(before)
    for _ in range(6):
        row, col = rng.integers(0, 150), rng.integers(0, 190)
        cells = before.cells.copy()
        window = cells[row : row + size, col : col + size]
        window[:] = rng.choice([FREE, FREE, FREE, FREE, OCCUPIED, UNKNOWN], window.shape)
        if rng.random() < 0.5:
            window[:] = FREE
        grid = OccupancyGrid(cells, 0.05, (0.0, 0.0))
        assert np.array_equal(clearances.of(grid), clearance_field(grid))
        before = grid


def test_a_map_in_another_place_is_no_later_state():
    one = OccupancyGrid(np.zeros((9, 9), dtype=np.int8), 0.05, (0.0, 0.0))
    cells = one.cells.copy()
    cells[3, 3] = OCCUPIED
    for resolution_m, origin_xy in ((0.05, (0.05, 0.0)), (0.1, (0.0, 0.0))):
        other = OccupancyGrid(cells, resolution_m, origin_xy)
        clearances = Clearances()
        clearances.of(one)
        assert np.array_equal(clearances.of(other), clearance_field(other))
