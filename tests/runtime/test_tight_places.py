import numpy as np

from explore_bt.exploration import clearance_field
from explore_bt.runtime.tight_places import TightPlaces
from explore_bt.types import FREE, OCCUPIED, OccupancyGrid


def floor() -> OccupancyGrid:
    return OccupancyGrid(np.full((40, 40), FREE, dtype=np.int8), 0.05, (0.0, 0.0), revision=7)


def test_without_tight_places_the_map_is_the_map() -> None:
    grid = floor()
    assert TightPlaces().mark(grid) is grid


def test_a_tight_place_closes_the_passage_around_it_and_opens_again() -> None:
    grid, places = floor(), TightPlaces()
    places.add((1.0, 1.0))
    marked = places.mark(grid)
    assert marked.value_at(1.0, 1.0) == OCCUPIED
    assert grid.value_at(1.0, 1.0) == FREE
    row, col = grid.cell_of(1.1, 1.0)
    assert clearance_field(marked)[row, col] < 0.25
    assert places.mark(grid) is marked
    assert places.reopen(chances=1) == 1
    assert places.mark(grid) is grid


def test_a_place_that_closes_again_stays_closed_once_its_chances_are_used_up() -> None:
    places = TightPlaces()
    places.add((1.0, 1.0))
    assert places.reopen(chances=1) == 1
    places.add((1.1, 1.0))
    places.add((1.6, 1.0))
    assert places.reopen(chances=1) == 1
    marked = places.mark(floor())
    assert marked.value_at(1.1, 1.0) == OCCUPIED
    assert marked.value_at(1.6, 1.0) == FREE
    assert places.reopen(chances=2) == 1


def test_a_place_outside_the_map_is_no_harm() -> None:
    places = TightPlaces()
    places.add((99.0, 99.0))
    np.testing.assert_array_equal(places.mark(floor()).cells, floor().cells)
