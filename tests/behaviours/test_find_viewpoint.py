import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from explore_bt.behaviours import FindViewpoint, GiveUpGoal
from explore_bt.exploration import clearance_field
from explore_bt.testing.fake_robot import FakeRobot
from explore_bt.tree import Blackboard, Status
from explore_bt.types import FREE, OCCUPIED, UNKNOWN, OccupancyGrid, Pose2, Waypoint

RESOLUTION = 0.1


def two_rooms(door_cells: int) -> OccupancyGrid:
    """A known room, 6 × 6 m, and an unknown one behind a door of so many cells in its right wall."""
    cells = np.full((62, 130), UNKNOWN, dtype=np.int8)
    cells[:62, :62] = OCCUPIED
    cells[1:61, 1:61] = FREE
    middle = 31
    cells[middle - door_cells // 2 : middle - door_cells // 2 + door_cells, 61] = FREE
    return OccupancyGrid(cells, RESOLUTION, (0.0, 0.0))


def find_in(grid: OccupancyGrid, pose: Pose2 = Pose2(1.0, 1.0, 0.0)) -> FindViewpoint:
    leaf = FindViewpoint("find", FakeRobot(grid, pose), Blackboard())
    leaf.tick_once()
    return leaf


def test_the_place_chosen_sees_through_the_open_door() -> None:
    leaf = find_in(two_rooms(9))
    assert leaf.status is Status.SUCCESS
    assert leaf.goal.expected_gain_m2 > 0.1
    assert abs(leaf.goal.heading_rad) < 1.6  # towards the door in the right wall


def test_a_place_given_up_is_not_chosen_again_and_in_the_end_named() -> None:
    leaf = find_in(two_rooms(9))
    for _ in range(10):
        if leaf.status is Status.FAILURE:
            break
        leaf.blackboard.write("failure", "no_path")
        GiveUpGoal("give up", leaf.robot, leaf.blackboard).tick_once()
        leaf.tick_once()
    assert leaf.status is Status.FAILURE
    places = leaf.blackboard["given_up"]
    assert len({place.position for place in places}) == len(places)
    assert any("no_path" in sentence for sentence in leaf.left_open)


def test_a_fully_known_room_leaves_nothing_and_says_so() -> None:
    leaf = find_in(two_rooms(0))
    assert leaf.status is Status.FAILURE
    assert leaf.reason == "no reachable frontier shows 0.10 m² of new area or more"
    assert leaf.left_open == ()


def test_a_place_that_breaks_its_promise_where_the_robot_stands_is_not_a_goal() -> None:
    grid = two_rooms(9)
    first = find_in(grid)
    again = find_in(grid, Pose2(*first.goal.position, 0.0))
    assert again.status is Status.FAILURE or again.goal.position != first.goal.position


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
    grid = OccupancyGrid(cells, RESOLUTION, (0.0, 0.0))
    leaf = find_in(grid, Pose2(3.5, 3.5, 0.0))
    if leaf.status is Status.SUCCESS:
        row, col = grid.cell_of(*leaf.goal.position)
        assert clearance_field(grid)[row, col] >= leaf.robot.footprint_radius_m


def test_giving_up_writes_place_and_reason() -> None:
    board = Blackboard()
    board.write("goal", Waypoint(Pose2(1.0, 2.0, 0.0)))
    board.write("failure", "held")
    leaf = GiveUpGoal("give up", FakeRobot(two_rooms(0)), board)
    leaf.tick_once()
    assert leaf.feedback_message == "(1.0, 2.0) is given up: held"
    assert board["given_up"][0].position == (1.0, 2.0)
