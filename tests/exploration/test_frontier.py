import math

import numpy as np
import pytest
from hypothesis import given, settings

from explore_bt.exploration import find_frontiers, frontier_mask
from explore_bt.types import FREE, OCCUPIED, UNKNOWN, OccupancyGrid

from .grids import drawn, random_cells


def at(grid, row, col):
    return grid.cells[row, col] if grid.contains_cell(row, col) else UNKNOWN


def is_frontier(grid, row, col, off_walls):
    if at(grid, row, col) != FREE:
        return False
    if off_walls and OCCUPIED in [at(grid, row + i, col + j) for i in (-1, 0, 1) for j in (-1, 0, 1)]:
        return False
    return UNKNOWN in [at(grid, row + i, col + j) for i, j in ((0, 1), (1, 0), (0, -1), (-1, 0))]


def clusters_of(cells):
    """8-connected clusters by flooding."""
    left, clusters = set(cells), []
    while left:
        stack, cluster = [left.pop()], set()
        while stack:
            row, col = stack.pop()
            cluster.add((row, col))
            beside = {(row + i, col + j) for i in (-1, 0, 1) for j in (-1, 0, 1)} & left
            left -= beside
            stack += beside
        clusters.append(cluster)
    return sorted(clusters, key=min)


@settings(deadline=None, max_examples=60)
@given(random_cells())
def test_frontiers_are_what_flooding_finds_in_the_order_of_their_first_cells(cells):
    grid = OccupancyGrid(cells, 0.1, (1.0, -2.0))
    for off_walls in (False, True):
        wanted = [(r, c) for r, c in np.ndindex(cells.shape) if is_frontier(grid, r, c, off_walls)]
        assert [tuple(rc) for rc in np.argwhere(frontier_mask(grid, off_walls=off_walls)).tolist()] == wanted
        found = find_frontiers(grid, off_walls=off_walls)
        assert [[tuple(c) for c in f.cells.tolist()] for f in found] == [
            sorted(c) for c in clusters_of(wanted)
        ]


def test_a_frontier_knows_its_place_and_its_size():
    grid = drawn(
        """
        #######
        #.....#
        #.....#
        #?????#
        """,
        origin_xy=(2.0, 3.0),
    )
    (frontier,) = find_frontiers(grid)
    assert frontier.centroid == pytest.approx((2.35, 3.25))
    assert frontier.middle_cell == (2, 3)
    assert frontier.size_m == pytest.approx(0.5)


def test_leaks_smaller_than_asked_for_are_left_out():
    grid = drawn("........\n????????\n........\n#?######")
    sizes = [f.size_m for f in find_frontiers(grid, 0.3, off_walls=False)]
    assert all(size >= 0.3 for size in sizes)
    diagonal = OccupancyGrid(np.where(np.eye(5, dtype=bool), FREE, UNKNOWN).astype(np.int8), 0.1, (0.0, 0.0))
    assert find_frontiers(diagonal)[0].size_m == pytest.approx(0.1 * (1 + 4 * math.sqrt(2)))


def test_the_edge_of_the_grid_is_a_frontier():
    assert len(find_frontiers(drawn("."))) == 1


def test_a_map_without_free_floor_has_no_frontier():
    assert find_frontiers(drawn("??#\n#??")) == ()
