import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from explore_bt.errors import UserError
from explore_bt.exploration import CoverageMeter
from explore_bt.exploration.coverage import coverage
from explore_bt.types import FREE, UNKNOWN, OccupancyGrid

from .grids import drawn, random_cells


def by_hand(truth, grid):
    mapped = []
    for row, col in np.argwhere(truth.cells == FREE).tolist():
        x, y = truth.center_of(row, col)
        r, c = grid.cell_of(x, y)
        near = [
            grid.cells[r + i, c + j]
            for i in range(-2, 3)
            for j in range(-2, 3)
            if math.hypot(i, j) <= 1.5 and grid.contains_cell(r + i, c + j)
        ]
        mapped.append(grid.value_at(x, y) != UNKNOWN and FREE in near)
    return sum(mapped) / len(mapped)


@settings(deadline=None, max_examples=60)
@given(
    random_cells(),
    random_cells(weights=".#?"),
    st.sampled_from([0.07, 0.1, 0.23]),
    st.sampled_from([(-0.513, -0.387), (0.031, 0.017), (0.4123, 3.1)]),
)
def test_coverage_is_what_counting_floor_cells_gives(truth_cells, cells, resolution_m, origin_xy):
    if not (truth_cells == FREE).any():
        truth_cells[0, 0] = FREE
    truth = OccupancyGrid(truth_cells, 0.1, (0.0137, -0.0071))
    grid = OccupancyGrid(cells, resolution_m, origin_xy)
    assert coverage(truth, grid) == pytest.approx(by_hand(truth, grid))


def test_one_meter_measures_growing_maps():
    meter = CoverageMeter(drawn("....\n####"))
    assert [meter.measure(drawn(text)) for text in ("????", "..??", "....")] == [0.0, 0.5, 1.0]


def test_floor_drawn_as_wall_counts_only_beside_free_floor():
    truth = drawn(".....")
    assert coverage(truth, drawn("...##")) == pytest.approx(0.8)
    assert coverage(truth, drawn("#####")) == 0.0


def test_a_world_without_floor_is_refused():
    with pytest.raises(UserError, match="no free cell"):
        CoverageMeter(drawn("##?"))


@settings(deadline=None, max_examples=60)
@given(random_cells(), random_cells(), st.integers(0, 2**32 - 1), st.sampled_from([0.07, 0.1]))
def test_looking_again_where_the_map_changed_is_as_good_as_looking_everywhere(
    truth_cells, cells, seed, resolution_m
):
    if not (truth_cells == FREE).any():
        truth_cells[0, 0] = FREE
    truth = OccupancyGrid(truth_cells, 0.1, (0.0137, -0.0071))
    meter, rng = CoverageMeter(truth), np.random.default_rng(seed)
    meter.measure(OccupancyGrid(cells.copy(), resolution_m, (0.0, 0.0)))
    for _ in range(4):
        row, col = (int(rng.integers(0, n)) for n in cells.shape)
        cells[max(row - 1, 0) : row + 2, max(col - 1, 0) : col + 2] = rng.choice([FREE, UNKNOWN, 100])
        grid = OccupancyGrid(cells.copy(), resolution_m, (0.0, 0.0))
        around = meter.measure_around(grid, grid.center_of(row, col), 1.5 * resolution_m)
        assert around == CoverageMeter(truth).measure(grid)
