import math

import numpy as np
import pytest

from explore_bt.exploration import (
    choose_viewpoints,
    clearance_field,
    find_frontiers,
    reachable_frontiers,
    travel_field,
    visible_unknown_area,
)
from explore_bt.types import FREE, OCCUPIED, UNKNOWN, OccupancyGrid

RANGE_M = 5.0


def two_rooms(door_cells: int) -> OccupancyGrid:
    """Two rooms of 4 × 4 m at 0.05 m; the far one is half known, the door this wide."""
    cells = np.full((82, 164), OCCUPIED, dtype=np.int8)
    cells[1:81, 1:81] = FREE
    cells[1:81, 83:123] = FREE
    cells[1:81, 123:163] = UNKNOWN
    cells[40 - door_cells // 2 : 40 - door_cells // 2 + door_cells, 81:83] = FREE
    return OccupancyGrid(cells, 0.05, (-1.0, 2.0))


def choice_on(grid, start=(40, 20), radius_m=0.28, **options):
    clearance = clearance_field(grid)
    travel = travel_field(clearance, start, radius_m, grid.resolution_m)
    frontiers = find_frontiers(grid, 0.2)
    return choose_viewpoints(
        grid, clearance, travel, frontiers, RANGE_M, radius_m=radius_m, **options
    ), travel


def test_a_viewpoint_can_be_reached_and_sees_new_area_ahead():
    grid = two_rooms(18)
    choice, travel = choice_on(grid)
    (view,) = choice.viewpoints
    assert choice.left_open == ()
    assert view.travel_m == pytest.approx(travel[grid.cell_of(*view.xy)])
    assert math.isfinite(view.travel_m)
    assert view.gain_m2 >= 0.1
    assert view.gain_m2 <= visible_unknown_area(grid, view.xy, RANGE_M, depth_m=1.0) + 1e-9
    ahead = math.atan2(view.frontier.centroid[1] - view.xy[1], view.frontier.centroid[0] - view.xy[0])
    assert abs(math.remainder(view.heading_rad - ahead, 2 * math.pi)) < math.pi / 2


def test_the_line_from_a_viewpoint_meets_the_frontier_over_free_floor():
    grid = two_rooms(18)
    view = choice_on(grid)[0].viewpoints[0]

    def is_in_view(cell):
        x, y = grid.center_of(*cell)
        way = np.linspace(0, 1, 400)[:, None]
        points = np.array(view.xy) * (1 - way) + np.array([x, y]) * way
        in_range = math.dist(view.xy, (x, y)) <= RANGE_M
        return in_range and all(grid.value_at(*p) == FREE for p in points)

    assert any(is_in_view(cell) for cell in view.frontier.cells.tolist())


def test_a_door_too_narrow_is_told_in_centimetres():
    # with a short view the far room's edge cannot be seen from the near room
    grid = two_rooms(8)
    clearance = clearance_field(grid)
    travel = travel_field(clearance, (40, 20), 0.28, 0.05)
    frontiers = find_frontiers(grid, 0.2)
    choice = choose_viewpoints(grid, clearance, travel, frontiers, 1.5, radius_m=0.28)
    assert choice.viewpoints == ()
    assert choice.left_open[0].reason == "too narrow by 11 cm: passage clearance 0.17 m, needs 0.28 m"
    assert reachable_frontiers(choice) == ()


def test_a_frontier_nobody_can_see_is_told():
    cells = np.full((60, 120), OCCUPIED, dtype=np.int8)
    cells[1:59, 1:50] = FREE
    cells[1:59, 70:90] = FREE  # seen in another life, no way there
    cells[1:59, 90:119] = UNKNOWN
    choice, _ = choice_on(OccupancyGrid(cells, 0.05, (0.0, 0.0)), start=(30, 20))
    assert [left.reason for left in choice.left_open] == ["no reachable place sees it"]


def test_a_frontier_with_little_behind_it_is_told():
    cells = np.full((60, 60), OCCUPIED, dtype=np.int8)
    cells[1:59, 1:58] = FREE
    cells[20:28, 58] = UNKNOWN  # a strip one cell thick before the wall
    choice, _ = choice_on(OccupancyGrid(cells, 0.05, (0.0, 0.0)), start=(30, 20))
    assert [left.reason for left in choice.left_open] == ["shows only 0.02 m² of new area"]


def test_places_tried_in_vain_are_not_chosen_again():
    grid = two_rooms(18)
    first = choice_on(grid)[0].viewpoints[0]
    second = choice_on(grid, tried=[first.xy])[0].viewpoints[0]
    assert math.dist(first.xy, second.xy) > 0.3
    gone = choice_on(grid, tried=[first.xy], tried_radius_m=20.0)[0]
    assert [left.reason for left in gone.left_open] == ["every place that sees it was tried"]


def test_reachable_frontiers_come_nearest_first_and_every_frontier_is_answered():
    cells = np.full((80, 200), UNKNOWN, dtype=np.int8)
    cells[20:60, 20:180] = FREE
    cells[19, 20:180] = cells[60, 20:180] = OCCUPIED
    grid = OccupancyGrid(cells, 0.05, (0.0, 0.0))
    choice, _ = choice_on(grid, start=(40, 150))
    assert len(choice.viewpoints) + len(choice.left_open) == len(find_frontiers(grid, 0.2))
    near, far = reachable_frontiers(choice)
    assert near.centroid[0] > far.centroid[0]


def test_a_rate_of_discount_weighs_travel_against_area():
    grid = two_rooms(18)
    eager = choice_on(grid, decay_per_m=0.0)[0].viewpoints[0]
    lazy = choice_on(grid, decay_per_m=2.0)[0].viewpoints[0]
    assert lazy.travel_m <= eager.travel_m
    assert lazy.gain_m2 <= eager.gain_m2 + 1e-9


def test_the_choice_is_the_same_every_time():
    grid = two_rooms(18)
    first, second = choice_on(grid)[0].viewpoints[0], choice_on(grid)[0].viewpoints[0]
    assert (first.xy, first.heading_rad, first.gain_m2) == (second.xy, second.heading_rad, second.gain_m2)
