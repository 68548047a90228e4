import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from explore_bt.exploration import clearance_at, clearance_field, find_refuge, gap_to_courses_m
from explore_bt.types import FREE, OCCUPIED, MovingObstacle, OccupancyGrid

RADIUS = 0.3
numbers = st.floats(-4.0, 4.0)


def corridor(branch_at: float | None) -> OccupancyGrid:
    """A corridor along x, 1.2 m wide about y = 0 and 10 m long; a side branch 1 m wide, 2 m deep."""
    cells = np.full((100, 200), OCCUPIED, dtype=np.int8)
    cells[38:62] = FREE
    if branch_at is not None:
        col = round((branch_at + 5.0) / 0.05)
        cells[62:98, col - 10 : col + 10] = FREE
    return OccupancyGrid(cells, 0.05, (-5.0, -2.5))


def someone(x: float, y: float, vx: float, vy: float) -> MovingObstacle:
    return MovingObstacle(1, (x, y), (vx, vy), 0.25, 0.0)


def refuge(grid: OccupancyGrid, *moving: MovingObstacle) -> tuple[float, float] | None:
    return find_refuge(grid, clearance_field(grid), (0.0, 0.0), moving, RADIUS)


def test_in_a_corridor_the_side_branch_is_the_refuge() -> None:
    place = refuge(corridor(1.0), someone(4.0, 0.0, -1.2, 0.0))
    assert place is not None
    x, y = place
    assert 0.5 < x < 1.5
    assert y > 0.6


def test_without_a_branch_it_stays() -> None:
    assert refuge(corridor(None), someone(4.0, 0.0, -1.2, 0.0)) is None


def test_a_branch_that_the_other_reaches_first_is_none() -> None:
    assert refuge(corridor(2.0), someone(2.5, 0.0, -1.2, 0.0)) is None


def test_with_nobody_about_it_stays() -> None:
    assert refuge(corridor(1.0)) is None


@settings(deadline=None, max_examples=60)
@given(numbers, numbers, st.floats(-1.6, 1.6), st.floats(-1.6, 1.6), st.integers(0, 100))
def test_a_refuge_is_a_place_to_go_to(x: float, y: float, vx: float, vy: float, seed: int) -> None:
    rng = np.random.default_rng(seed)
    cells = np.full((120, 120), FREE, dtype=np.int8)
    for row, col in rng.integers(0, 115, (12, 2)):
        cells[row : row + 5, col : col + 5] = OCCUPIED
    cells[52:68, 52:68] = FREE
    grid = OccupancyGrid(cells, 0.05, (-3.0, -3.0))
    person = someone(x, y, vx, vy)
    place = refuge(grid, person)
    if place is None:
        return
    assert clearance_at(grid, np.array([place]), 1.0)[0] >= RADIUS - 0.05
    assert math.dist(place, (0.0, 0.0)) <= 3.0
    assert math.dist(place, person.xy) > math.dist(place, (0.0, 0.0))
    gaps = gap_to_courses_m(np.array([place, (0.0, 0.0)]), (person,))
    assert gaps[0] > gaps[1]


@given(numbers, numbers, st.floats(-1.6, 1.6), st.floats(-1.6, 1.6))
def test_the_gap_to_a_course_is_that_to_the_nearest_place_on_it(
    x: float, y: float, vx: float, vy: float
) -> None:
    person = someone(x, y, vx, vy)
    speed = math.hypot(vx, vy)
    until_s = 8.0 / speed if speed > 0.2 else 0.0
    walked = np.array([person.at(t) for t in np.linspace(0.0, until_s, 2001)])
    slow = np.hypot(*walked.T).min() - person.radius_m
    assert gap_to_courses_m(np.zeros((1, 2)), (person,))[0] == pytest.approx(slow, abs=1e-2)
