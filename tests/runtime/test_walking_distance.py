from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from explore_bt.runtime.walking_distance import WalkingDistance, spare_of_walkers_m
from explore_bt.types import FREE, OCCUPIED, UNKNOWN, OccupancyGrid, Pose2

CELL = 0.05
HERE = Pose2.identity()
near = st.floats(-1.8, 1.8)


def floor(wall: bool = False, door: float = 0.0) -> OccupancyGrid:
    """8 x 8 m about the origin; a wall at x = 1, all along y but for a door 1 m wide about y = ``door``."""
    cells = np.full((160, 160), FREE, dtype=np.int8)
    if wall:
        y = -4.0 + CELL * (np.arange(160) + 0.5)
        cells[np.abs(y - door) > 0.5, 100:102] = OCCUPIED
    return OccupancyGrid(cells, CELL, (-4.0, -4.0))


def distance(grid: OccupancyGrid, centre: tuple[float, float], radius_m: float = 0.0) -> WalkingDistance:
    return WalkingDistance(grid, HERE, np.array([centre]), np.array([radius_m]))


@settings(deadline=None)
@given(near, near, near, near, st.floats(0.0, 0.5))
def test_on_open_floor_it_is_the_straight_line(x, y, at_x, at_y, radius_m) -> None:
    (found,) = distance(floor(), (x, y), radius_m).to(np.array([[at_x, at_y]]))
    straight = math.hypot(at_x - x, at_y - y) - radius_m
    assert straight - 1e-9 <= found <= max(straight, 0.0) + 1e-9


@settings(deadline=None)
@example(x=1.375, y=1.0, at_x=0.5, at_y=0.0, door=0.0)
@given(st.floats(1.3, 2.0), near, st.floats(-1.0, 0.7), near, st.floats(-1.5, 1.5))
def test_round_a_wall_it_is_never_more_than_the_shortest_way(x, y, at_x, at_y, door) -> None:
    """Through the best place in the door, but for the cells that both ends lie in."""
    (found,) = distance(floor(wall=True, door=door), (x, y)).to(np.array([[at_x, at_y]]))
    exact = min(through(x, y, at_x, at_y, door + k) for k in np.linspace(-0.5, 0.5, 81))
    assert math.hypot(at_x - x, at_y - y) - 1e-9 <= found <= exact + math.sqrt(2.0) * CELL


def through(x: float, y: float, at_x: float, at_y: float, gap_y: float) -> float:
    return math.hypot(x - 1.05, y - gap_y) + math.hypot(at_x - 1.05, at_y - gap_y)


def test_behind_a_wall_it_is_far() -> None:
    assert distance(floor(wall=True, door=3.0), (1.4, 0.0)).to(np.array([[0.6, 0.0]]))[0] == pytest.approx(
        3.0
    )


def test_a_body_that_the_map_has_drawn_is_no_wall_around_itself() -> None:
    rows, cols = np.indices((160, 160))
    cells = np.where(np.hypot(rows - 80, cols - 100) < 7, OCCUPIED, FREE).astype(np.int8)
    grid = OccupancyGrid(cells, CELL, (-4.0, -4.0))
    x, y = grid.center_of(80, 100)
    (found,) = distance(grid, (x, y), 0.25).to(np.array([[0.0, y]]))
    assert found == pytest.approx(x - 0.25)


def test_what_is_unknown_can_be_walked_through() -> None:
    grid = OccupancyGrid(np.full((160, 160), UNKNOWN, dtype=np.int8), CELL, (-4.0, -4.0))
    assert distance(grid, (1.0, 0.0)).to(np.array([[0.0, 0.0]]))[0] == pytest.approx(1.0)


@settings(deadline=None)
@given(
    st.tuples(near, near, near, near),
    st.floats(0.0, 0.4),
    st.lists(st.tuples(st.floats(-math.pi, math.pi), st.floats(0.0, 2.5)), min_size=5, max_size=30),
    st.floats(-math.pi, math.pi),
)
def test_nobody_with_such_legs_is_where_it_says_that_nobody_can_be(state, off, pushes, wrong_way) -> None:
    """Somebody accelerates at random, told with a wrong velocity; the place is one they come to."""
    place, velocity = np.array(state[:2]), np.clip(np.array(state[2:]), -1.1, 1.1)
    told = velocity + off * np.array([math.cos(wrong_way), math.sin(wrong_way)])
    walker = np.array([[*place, *told, 0.25, 10.0, off]])
    dt_s = 0.05
    for k, (course, push) in enumerate(pushes, 1):
        pushed = velocity + push * dt_s * np.array([math.cos(course), math.sin(course)])
        faster = math.hypot(*pushed) > 1.6
        place = place + dt_s * (velocity if faster else 0.5 * (velocity + pushed))
        velocity = velocity if faster else pushed
        (spare,) = spare_of_walkers_m(place[None], np.array([10.0 + k * dt_s]), walker, 1.6, 2.5)
        assert spare <= -0.25 + 1e-9
