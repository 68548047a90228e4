from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from explore_bt.exploration import Ground, Reach, clearance_field, travel_field
from explore_bt.types import FREE, OCCUPIED, UNKNOWN, OccupancyGrid

HERE_XY = (3.0, 3.0)


def boxes(
    seed: int, resolution_m: float = 0.05, origin_xy: tuple[float, float] = (0.0, 0.0)
) -> OccupancyGrid:
    """Random boxes and unknown patches on 6 × 6 m of floor, drawn in cells of 10 cm; the middle is free."""
    rng = np.random.default_rng(seed)
    cells = np.full((60, 60), FREE, dtype=np.int8)
    for value in [OCCUPIED] * 14 + [UNKNOWN] * 5:
        row, col = rng.integers(0, 60, 2)
        cells[row : row + rng.integers(1, 10), col : col + rng.integers(1, 10)] = value
    cells[26:35, 26:35] = FREE
    parts = round(0.1 / resolution_m)
    return OccupancyGrid(np.kron(cells, np.ones((parts, parts), dtype=np.int8)), resolution_m, origin_xy)


def reach_in(grid: OccupancyGrid, radius_m: float) -> Reach:
    return Reach(Ground(grid), clearance_field(grid), HERE_XY, radius_m)


@settings(deadline=None, max_examples=25)  # compiles
@given(
    st.integers(0, 999),
    st.sampled_from([0.1, 0.05, 0.025]),
    st.sampled_from([0.15, 0.2, 0.25]),
    st.tuples(*[st.floats(-0.2, 0.2)] * 2),
)
def test_there_is_room_to_stand_at_every_point_and_a_way_to_it(
    seed: int, resolution_m: float, radius_m: float, origin_xy: tuple[float, float]
) -> None:
    grid = boxes(seed, resolution_m, origin_xy)
    reach = reach_in(grid, radius_m)
    blocks = np.argwhere(reach.room_m > 0.0)
    points = reach.points(blocks)
    cells = tuple(grid.cells_of(points).T)
    clearance_m = clearance_field(grid)
    travel_m = travel_field(clearance_m, grid.cell_of(*HERE_XY), radius_m, grid.resolution_m)
    assert np.isfinite(travel_m[cells]).all()
    assert clearance_m[cells].min() >= radius_m - 1e-6
    assert np.abs(points - reach.ground.grid.centers_of(blocks)).max() < 0.05
    assert reach.room_m[tuple(blocks.T)].min() >= radius_m - 1e-6
    way_blocks = reach.way_block_of(blocks)
    assert np.isfinite(reach.from_here_m[tuple(way_blocks.T)]).all()


def test_every_passable_cell_that_can_be_come_to_lies_in_a_block_in_reach() -> None:
    grid = boxes(3)
    clearance_m = clearance_field(grid)
    travel_m = travel_field(clearance_m, grid.cell_of(*HERE_XY), 0.2, grid.resolution_m)
    reach = reach_in(grid, 0.2)
    cells = np.argwhere(np.isfinite(travel_m))
    assert (reach.room_m[tuple(reach.ground.blocks.of(cells).T)] > 0.0).all()


@pytest.mark.parametrize("seed", range(8))
def test_a_finer_drawing_of_the_same_map_has_the_same_room_where_there_is_some_to_spare(seed: int) -> None:
    coarse, fine = (reach_in(boxes(seed, resolution_m), 0.2) for resolution_m in (0.1, 0.05))
    roomy = coarse.room_m > 0.25
    assert roomy.any()
    np.testing.assert_allclose(fine.room_m[roomy], coarse.room_m[roomy], atol=1e-6)
    np.testing.assert_allclose(fine.points(np.argwhere(roomy)), coarse.points(np.argwhere(roomy)))


def test_a_tight_metre_counts_more_than_a_roomy_one() -> None:
    cells = np.full((30, 80), OCCUPIED, dtype=np.int8)
    cells[5:25, 2:40] = FREE
    cells[12:18, 40:78] = FREE
    grid = OccupancyGrid(cells, 0.1, (0.0, 0.0))
    reach = Reach(Ground(grid), clearance_field(grid), (3.0, 1.5), 0.2)
    blocks = reach.ground.block_of(np.array([[1.0, 1.5], [5.0, 1.5], [6.0, 1.5], [7.0, 1.5]]))
    roomy_m, *tight_m = reach.from_here_m[tuple(reach.way_block_of(blocks).T)].tolist()
    assert roomy_m == pytest.approx(2.0, abs=0.25)
    assert np.diff(tight_m) == pytest.approx([1.25, 1.25], abs=0.1)
