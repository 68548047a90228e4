from __future__ import annotations

import math

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from explore_bt.behaviours import FindFrontier, FindView, GivenUp
from explore_bt.exploration import clearance_field
from explore_bt.testing.fake_robot import FakeRobot
from explore_bt.tree import Blackboard, Leaf, Status
from explore_bt.types import FREE, OCCUPIED, UNKNOWN, OccupancyGrid, Pose2

HERE = Pose2(3.0, 2.0, 0.0)


def hall(open_left: bool = True, open_right: bool = True) -> OccupancyGrid:
    """A known hall of 6 × 4 m whose ends are walls, or unknown from there on."""
    cells = np.full((42, 100), UNKNOWN, dtype=np.int8)
    cells[1:41, 20:80] = FREE
    cells[[0, 41], :] = OCCUPIED
    cells[:, 19] = UNKNOWN if open_left else OCCUPIED
    cells[:, 80] = UNKNOWN if open_right else OCCUPIED
    return OccupancyGrid(cells, 0.1, (-2.0, 0.0))


def ticked(cls: type[Leaf], grid: OccupancyGrid, **bindings: object) -> Leaf:
    leaf = cls("find", FakeRobot(grid, HERE), Blackboard(), bindings)
    leaf.tick_once()
    return leaf


def test_a_view_is_a_place_with_room_on_the_side_that_is_open() -> None:
    leaf = ticked(FindView, hall(open_left=False))
    assert leaf.status is Status.SUCCESS
    goal = leaf.blackboard["goal"]
    assert goal.position[0] > HERE.x
    assert goal.expected_gain_m2 >= 0.1


def test_of_two_sides_alike_the_one_ahead_is_taken() -> None:
    assert ticked(FindView, hall()).blackboard["goal"].position[0] > HERE.x


def test_where_nothing_is_left_the_reason_is_told() -> None:
    leaf = ticked(FindView, hall(open_left=False, open_right=False))
    assert leaf.status is Status.FAILURE
    assert leaf.blackboard["reason"] == "no reachable place shows 0.10 m² of new area or more"
    assert leaf.blackboard["left_open"] == ()


def test_scraps_are_left_where_the_mission_allows_it_and_named() -> None:
    cells = hall(open_left=False, open_right=False).cells.copy()
    cells[20:23, 76:80] = UNKNOWN
    grid = OccupancyGrid(cells, 0.1, (-2.0, 0.0))
    assert ticked(FindView, grid, min_gain=0.05).status is Status.SUCCESS
    leaf = ticked(FindView, grid, min_gain=0.05, leave=0.05)
    assert leaf.status is Status.FAILURE
    assert "too little to be worth the way" in leaf.blackboard["left_open"][0]


def test_the_nearest_frontier_is_driven_up_to() -> None:
    grid = hall()
    leaf = FindFrontier("find", FakeRobot(grid, Pose2(1.5, 2.0, 0.0)), Blackboard(), {})
    leaf.tick_once()
    assert leaf.status is Status.SUCCESS
    assert leaf.blackboard["goal"].position[0] < 0.5


def test_every_frontier_is_drawn_with_what_was_decided_about_it() -> None:
    robot, board = FakeRobot(hall(), Pose2(1.5, 2.0, 0.0)), Blackboard()
    leaf = FindFrontier("find", robot, board, {})
    leaf.tick_once()
    taken, other = robot.drawn[-1].frontiers or ()
    assert (taken.state, other.state, other.reason) == ("taken", "open", "")
    assert (taken.x, taken.y) == leaf.goal.looks_at
    board.write("given_up", (GivenUp(leaf.goal.position, "no_path", leaf.goal.looks_at),))
    leaf.tick_once()
    taken, refused = robot.drawn[-1].frontiers or ()
    assert (taken.x, refused.state, refused.reason) == (other.x, "rejected", "given up before: no_path")


def test_the_views_are_drawn_with_the_goal_first_and_what_was_given_up_last() -> None:
    robot, board = FakeRobot(hall(), HERE), Blackboard()
    board.write("given_up", (GivenUp((3.0, 3.0), "no_path"),))
    leaf = FindView("find", robot, board, {})
    leaf.tick_once()
    drawing = robot.drawn[-1]
    first, *_, last = drawing.views or ()
    assert (first.x, first.y, first.state, first.reason) == (*leaf.goal.position, "taken", "the next goal")
    assert first.gain_m2 > 0.0
    assert (last.x, last.y, last.state, last.reason) == (3.0, 3.0, "rejected", "no_path")
    assert robot.drawn[0].sectors  # the safe headings, as places to look from


def test_a_goal_that_still_shows_as_much_once_it_is_reached_is_not_chosen_again() -> None:
    grid, blackboard = hall(open_left=False), Blackboard()
    robot = FakeRobot(grid, HERE)
    leaf = FindView("find", robot, blackboard, {})
    leaf.tick_once()
    first = blackboard["goal"].position
    robot.pose = Pose2(*first, 0.0)
    leaf.tick_once()
    assert [place.was_seen for place in blackboard["given_up"] if place.position == first] == [True]
    robot.pose = HERE
    leaf.tick_once()
    assert leaf.status is Status.FAILURE or math.dist(blackboard["goal"].position, first) > 0.3


def test_places_looked_from_in_vain_are_named_only_if_their_area_stayed_unknown() -> None:
    whole = hall(open_left=False, open_right=False)
    cells = whole.cells.copy()
    cells[20:24, 76:80] = UNKNOWN
    everywhere = tuple(
        GivenUp((float(x), float(y)), "still unknown after looking from here", was_seen=True)
        for x in np.arange(0.1, 6.0, 0.3)
        for y in np.arange(0.2, 4.0, 0.3)
    )
    for grid, is_named in ((OccupancyGrid(cells, 0.1, (-2.0, 0.0)), True), (whole, False)):
        blackboard = Blackboard()
        blackboard.write("given_up", everywhere)
        leaf = FindView("find", FakeRobot(grid, HERE), blackboard, {})
        leaf.tick_once()
        assert leaf.status is Status.FAILURE
        assert any("after looking" in each for each in blackboard["left_open"]) is is_named


@given(st.integers(0, 2**32 - 1))
@settings(deadline=None, max_examples=25)
def test_no_goal_is_ever_proposed_where_the_footprint_does_not_fit(seed: int) -> None:
    rng = np.random.default_rng(seed)
    cells = np.full((80, 80), UNKNOWN, dtype=np.int8)
    cells[10:60, 10:60] = FREE
    for _ in range(12):
        row, col = rng.integers(5, 70, 2)
        height, width = rng.integers(1, 12, 2)
        cells[row : row + height, col : col + width] = rng.choice([OCCUPIED, UNKNOWN])
    cells[30:40, 30:40] = FREE
    robot = FakeRobot(OccupancyGrid(cells, 0.1, (0.0, 0.0)), Pose2(3.5, 3.5, 0.0))
    robot.least_margin_m = 0.0
    for cls in (FindView, FindFrontier):
        leaf = cls("find", robot, Blackboard(), {})
        leaf.tick_once()
        if leaf.status is Status.SUCCESS:
            row, col = robot.grid.cell_of(*leaf.blackboard["goal"].position)
            assert clearance_field(robot.grid)[row, col] >= robot.footprint_radius_m
