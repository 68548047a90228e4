import math

import numpy as np
import pytest
from numpy.typing import NDArray

from explore_bt.exploration import clearance_field, find_sidestep
from explore_bt.types import FREE, OCCUPIED, OccupancyGrid

Course = NDArray[np.float64]


def corridor(niche: bool) -> OccupancyGrid:
    """12 m long, 1 m wide along y = 0; with a niche of 1 m by 1 m above x = 3 m, and a room at x > 10 m."""
    cells = np.full((80, 260), OCCUPIED, dtype=np.int8)
    cells[30:50, 10:230] = FREE
    cells[10:70, 210:250] = FREE
    if niche:
        cells[50:70, 60:80] = FREE
    return OccupancyGrid(cells, 0.05, (-0.5, -2.0))


COURSE = np.column_stack((np.linspace(5.0, 11.0, 25), np.zeros(25)))


def sidestep(
    grid: OccupancyGrid, here: tuple[float, float], course: np.ndarray
) -> tuple[float, float] | None:
    return find_sidestep(grid, clearance_field(grid), here, 0.3, course, 0.65)


def test_the_place_is_off_the_course_and_come_to_without_passing() -> None:
    place = sidestep(corridor(niche=False), (6.0, 0.0), COURSE)
    assert place is not None
    assert place[0] > 10.0, "into the room behind, not past who comes"
    assert np.hypot(*(COURSE - place).T).min() >= 0.65


def test_a_niche_behind_whoever_comes_is_none() -> None:
    with_niche, without = (sidestep(corridor(niche), (6.0, 0.0), COURSE) for niche in (True, False))
    assert with_niche == without


def test_a_niche_on_the_own_side_is_the_nearest_place() -> None:
    place = sidestep(corridor(niche=True), (4.0, 0.0), np.column_stack((np.linspace(6, 0, 25), np.zeros(25))))
    assert place is not None
    assert place[0] == pytest.approx(3.0, abs=0.5)
    assert place[1] > 0.5


def test_at_a_dead_end_there_is_none() -> None:
    course = np.column_stack((np.linspace(2.5, 0.2, 12), np.zeros(12)))
    assert sidestep(corridor(niche=False), (1.2, 0.0), course) is None


def test_who_is_off_the_course_already_stays() -> None:
    place = sidestep(corridor(niche=True), (3.0, 0.9), np.column_stack((np.linspace(6, 0, 25), np.zeros(25))))
    assert place is not None
    assert math.dist(place, (3.0, 0.9)) < 0.1
