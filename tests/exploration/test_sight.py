import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from explore_bt.exploration.places import best_places
from explore_bt.exploration.sight import sights_of
from explore_bt.types import FREE, OccupancyGrid

from .grids import drawn, random_cells


def sees(cells, a, b):
    """Dense sampling along the line; None where it runs through a corner, where sampling is blind."""
    way = np.linspace(0, 1, 2003)[:, None]
    points = np.array(a) * (1 - way) + np.array(b) * way + 0.5
    if (np.abs(points - np.round(points)).max(axis=1) < 2e-2).any():
        return None
    return all(cells[int(r), int(c)] == FREE for r, c in points)


@settings(deadline=None, max_examples=80)
@given(random_cells(10, "....#?"), st.data())
def test_a_place_sees_a_cell_where_dense_sampling_meets_only_free_cells(cells, data):
    place, target = (data.draw(st.tuples(*(st.integers(0, n - 1) for n in cells.shape))) for _ in range(2))
    expected = sees(cells, place, target)
    far = math.dist(place, target)
    if expected is None or abs(far - 6.0) < 1e-9:
        return
    grid = OccupancyGrid(cells, 0.1, (0.0, 0.0))
    sights = sights_of(grid, np.array([place]), np.array([target]), 0.6)
    assert len(sights.places) == int(expected and far < 6.0)
    if len(sights.places):
        assert abs(sights.distance_m[0] - 0.1 * far) < 1e-9


@pytest.mark.parametrize(("text", "is_seen"), [(".#\n..", True), ("..\n#.", True), (".#\n?.", False)])
def test_sight_passes_a_corner_if_either_cell_beside_it_is_free(text, is_seen):
    sights = sights_of(drawn(text), np.array([[0, 0]]), np.array([[1, 1]]), 1.0)
    assert len(sights.places) == int(is_seen)


@settings(deadline=None, max_examples=60)
@given(st.lists(st.floats(-3.1, 3.1), min_size=1, max_size=10, unique=True))
def test_the_angle_filled_holds_every_cell_seen(bearings):
    grid = OccupancyGrid(np.zeros((81, 81), np.int8), 0.1, (0.0, 0.0))
    targets = np.unique(
        [[40 + round(30 * math.sin(b)), 40 + round(30 * math.cos(b))] for b in bearings], axis=0
    )
    sights = sights_of(grid, np.array([[40, 40]]), targets, 4.0)
    for row, col in targets:
        off = abs(math.remainder(math.atan2(row - 40, col - 40) - sights.heading_rad[0], 2 * math.pi))
        assert off <= sights.width_rad[0] / 2 + 1e-9


@settings(deadline=None, max_examples=40)
@given(random_cells(20), st.integers(1, 6), st.integers(0, 99))
def test_every_block_is_represented_by_its_best_cell(cells, block, seed):
    score = np.where(cells == FREE, np.random.default_rng(seed).random(cells.shape), 0).astype(np.float32)
    expected = []
    for row in range(0, cells.shape[0], block):
        for col in range(0, cells.shape[1], block):
            part = score[row : row + block, col : col + block]
            if part.max() > 0:
                r, c = np.unravel_index(part.argmax(), part.shape)
                expected.append([row + int(r), col + int(c)])
    assert best_places(score, block).tolist() == expected
