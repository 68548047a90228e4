from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from explore_bt.exploration import Ground
from explore_bt.exploration.ground import GroundMemory
from explore_bt.types import FREE, OCCUPIED, UNKNOWN, OccupancyGrid
from tests.exploration.grids import random_cells


def room_by_hand(grid: OccupancyGrid, x: float, y: float) -> float:
    """From a point to the nearest square that is not free, or to the edge of the map."""
    size_m, cell_m = np.array(grid.shape[::-1]) * grid.resolution_m, grid.resolution_m
    room_m = min(x, y, size_m[0] - x, size_m[1] - y)
    for row, col in np.argwhere(grid.cells != FREE).tolist():
        away_x = max(col * cell_m - x, x - (col + 1) * cell_m, 0.0)
        away_y = max(row * cell_m - y, y - (row + 1) * cell_m, 0.0)
        room_m = min(room_m, math.hypot(away_x, away_y))
    return max(room_m, 0.0)


@settings(deadline=None, max_examples=40)  # compiles
@given(random_cells(13, ".......#?"), st.sampled_from([0.02, 0.05, 0.1, 0.2]))
def test_room_is_the_way_from_the_middle_to_the_nearest_square_that_is_not_free(
    cells: np.ndarray, resolution_m: float
) -> None:
    grid = OccupancyGrid(cells, resolution_m, (0.0, 0.0))
    ground = Ground(grid)
    for block in np.argwhere(ground.room_m >= 0.0).tolist():
        x, y = ground.grid.center_of(*block)
        assert ground.room_m[tuple(block)] == pytest.approx(room_by_hand(grid, x, y), abs=1e-5)


@settings(deadline=None, max_examples=40)  # compiles
@given(random_cells(16, ".....#?"), st.integers(-9, 9), st.integers(-9, 9), st.sampled_from([2, 4]))
def test_a_finer_drawing_of_the_same_map_has_the_same_ground(
    cells: np.ndarray, row: int, col: int, fineness: int
) -> None:
    coarse = OccupancyGrid(cells, 0.1, (0.1 * col, 0.1 * row))
    parts = np.ones((fineness, fineness), dtype=np.int8)
    fine = OccupancyGrid(np.kron(cells, parts), 0.1 / fineness, coarse.origin_xy)
    one, other = Ground(coarse), Ground(fine)
    assert np.array_equal(one.grid.cells, other.grid.cells)
    np.testing.assert_allclose(one.grid.origin_xy, other.grid.origin_xy)
    np.testing.assert_allclose(one.room_m, other.room_m, atol=1e-6)


@settings(deadline=None, max_examples=40)
@given(random_cells(30, ".......#?"), st.data())
def test_the_ground_of_a_later_state_is_the_same_as_one_made_anew(cells: np.ndarray, data) -> None:
    memory = GroundMemory()
    for _ in range(3):
        grid = OccupancyGrid(cells, 0.05, (0.35, -0.1))
        later, anew = Ground(grid, memory), Ground(grid)
        assert np.array_equal(later.grid.cells, anew.grid.cells)
        assert np.array_equal(later.room_m, anew.room_m)
        cells = cells.copy()
        row, col = data.draw(st.integers(0, 29)), data.draw(st.integers(0, 29))
        cells[row : row + 3, col : col + 5] = data.draw(st.sampled_from([FREE, OCCUPIED, UNKNOWN]))


def test_a_point_between_two_blocks_lies_in_the_later_one() -> None:
    ground = Ground(OccupancyGrid(np.zeros((40, 40), dtype=np.int8), 0.05, (0.0, 0.0)))
    for x in np.arange(1, 19) * 0.1:
        (row, col), (row_below, col_below) = ground.block_of(
            np.array([[x, x], [x - 1e-9, x + 1e-9]])
        ).tolist()
        assert (row, col) == (row_below, col_below) == (round(x * 10), round(x * 10))
        assert ground.block_of(np.array([[x - 0.01, x + 0.01]])).tolist() == [[row, col - 1]]


def test_patches_of_unknown_are_specks_unless_they_are_large_or_at_the_edge() -> None:
    cells = np.full((64, 64), FREE, dtype=np.int8)
    cells[20:23, 20:23] = cells[40, 40] = cells[0, 30] = UNKNOWN
    ground = Ground(OccupancyGrid(cells, 0.1, (0.0, 0.0)))
    left = np.argwhere(ground.without_specks(0.05) == UNKNOWN).tolist()
    assert len(left) == 10
    assert [0, 30] in left
    assert [40, 40] not in left
