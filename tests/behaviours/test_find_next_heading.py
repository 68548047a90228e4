import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from explore_bt.behaviours import FindNextHeading, RecordWaypoint, ResetHalfPlanes
from explore_bt.testing.fake_robot import FakeRobot, full_circle_scan
from explore_bt.tree import Blackboard, Status
from explore_bt.types import FREE, OCCUPIED, UNKNOWN, OccupancyGrid, Pose2, Scan2D, Waypoint


def endless_floor(center: Pose2) -> OccupancyGrid:
    """Free 3 m around a pose, unknown beyond: there is always something to see ahead."""
    cells = np.full((160, 160), UNKNOWN, dtype=np.int8)
    grid = OccupancyGrid(cells.copy(), 0.1, (center.x - 8.0, center.y - 8.0))
    rows, cols = np.indices(cells.shape)
    near = np.hypot(rows - 79.5, cols - 79.5) * 0.1 < 3.0
    return replace(grid, cells=np.where(near, FREE, UNKNOWN).astype(np.int8))


def leaf(robot: FakeRobot, board: Blackboard, **bindings: object) -> FindNextHeading:
    return FindNextHeading("find", robot, board, bindings)


@given(st.floats(-math.pi, math.pi), st.sampled_from(["all", 1, 3]), st.sampled_from([0.5, 1.0]))
@settings(deadline=None, max_examples=15)
def test_lemma_1_without_obstacles_the_robot_goes_straight_on_for_ever(
    heading: float, half_planes: object, cosine: float
) -> None:
    robot, board = FakeRobot(endless_floor(Pose2(0, 0, 0)), Pose2(0.0, 0.0, heading)), Blackboard()
    find = leaf(robot, board, half_planes=half_planes, revisit_cosine=cosine)
    record = RecordWaypoint("record", robot, board)
    RecordWaypoint("start", robot, board, {"place": "here"}).tick_once()
    for k in range(1, 6):
        robot.grid = endless_floor(robot.pose)
        find.tick_once()
        assert find.status is Status.SUCCESS, find.feedback_message
        robot.pose = find.goal.pose
        record.tick_once()
        assert robot.pose.x == pytest.approx(1.5 * k * math.cos(heading), abs=1e-6)
        assert robot.pose.y == pytest.approx(1.5 * k * math.sin(heading), abs=1e-6)
        assert math.cos(robot.pose.yaw_rad - heading) == pytest.approx(1.0)


def scan_with_walls(*walls: tuple[float, float, float]) -> Scan2D:
    """All free but for (from degrees, to degrees, range)."""
    degrees = np.arange(360) - 180.0
    ranges = np.full(360, np.inf, dtype=np.float32)
    for first, last, distance in walls:
        ranges[(degrees >= first) & (degrees <= last)] = distance
    return full_circle_scan(ranges)


def test_the_widest_sector_wins_and_the_words_say_so() -> None:
    robot, board = FakeRobot(endless_floor(Pose2(0, 0, 0))), Blackboard()
    robot.latest_scan = scan_with_walls((-40.0, -20.0, 1.0))
    find = leaf(robot, board)
    find.tick_once()
    assert find.goal.heading_rad > 0.0
    assert find.feedback_message.startswith("2 free sectors; took ")


def test_a_revisit_in_the_same_direction_is_refused_in_words_and_the_next_sector_is_taken() -> None:
    robot, board = FakeRobot(endless_floor(Pose2(0, 0, 0))), Blackboard()
    robot.latest_scan = scan_with_walls((-40.0, -20.0, 1.0))
    find = leaf(robot, board)
    find.tick_once()
    board.write("visited", (Waypoint(find.goal.pose),))
    find.tick_once()
    refusal = "visited, same direction: 0.00 m from waypoint 0, 0° off"
    assert f"2 free sectors; 94° at +43° refused ({refusal}); took 34° at -73° → " in find.feedback_message
    assert find.goal.heading_rad < 0.0
    (drawing,) = robot.drawn[1:]
    refused, taken = drawing.sectors or ()
    assert (refused.state, refused.reason, taken.state) == ("rejected", refusal, "taken")


def test_the_drawing_holds_the_sectors_on_the_map_and_the_half_planes_that_constrain() -> None:
    robot, board = FakeRobot(endless_floor(Pose2(1, 2, 0)), Pose2(1.0, 2.0, math.pi / 2)), Blackboard()
    robot.latest_scan = scan_with_walls((-40.0, -20.0, 1.0))
    RecordWaypoint("start", robot, board, {"place": "here"}).tick_once()
    leaf(robot, board).tick_once()
    (drawing,) = robot.drawn
    (plane,) = drawing.half_planes or ()
    assert (plane.x, plane.y, round(plane.normal_x, 9), plane.normal_y) == (1.0, 2.0, 0.0, 1.0)
    taken, open_one = drawing.sectors or ()
    assert (taken.state, open_one.state, open_one.reason) == ("taken", "open", "")
    assert (taken.x, taken.y, taken.range_m) == (1.0, 2.0, 1.2)
    assert taken.to_rad == pytest.approx(math.pi, abs=1e-6)  # the left end of the semicircle ahead
    assert drawing.layers().keys() == {"sectors", "half_planes"}


def test_the_opposite_direction_through_a_visited_place_is_allowed() -> None:
    robot, board = FakeRobot(endless_floor(Pose2(0, 0, 0))), Blackboard()
    board.write("visited", (Waypoint(Pose2(1.5, 0.0, math.pi)),))
    find = leaf(robot, board)
    find.tick_once()
    assert find.status is Status.SUCCESS


def test_the_half_planes_forbid_going_back_until_they_are_reset() -> None:
    robot, board = FakeRobot(endless_floor(Pose2(0, 0, 0)), Pose2(0.0, 0.0, math.pi)), Blackboard()
    RecordWaypoint("ahead", robot, board, {"place": "here"}).tick_once()
    robot.pose = Pose2(0.0, 0.0, 0.0)  # it has turned round
    find = leaf(robot, board, revisit=False)
    find.tick_once()
    assert find.status is Status.FAILURE
    assert "(outside the half-planes: 1.50 m behind that of (0.0, 0.0))" in find.feedback_message
    ResetHalfPlanes("reset", robot, board).tick_once()
    find.tick_once()
    assert find.status is Status.SUCCESS


def test_looking_behind_finds_the_way_back() -> None:
    robot, board = FakeRobot(endless_floor(Pose2(0, 0, 0))), Blackboard()
    robot.latest_scan = scan_with_walls((-100.0, 100.0, 0.8))
    ahead = leaf(robot, board)
    ahead.tick_once()
    assert ahead.feedback_message == "no free sectors"
    behind = leaf(robot, board, look="behind")
    behind.tick_once()
    assert behind.goal.position[0] < -1.0


def test_where_everything_is_known_no_heading_is_worth_taking() -> None:
    known = OccupancyGrid(np.full((200, 200), FREE, dtype=np.int8), 0.1, (-10.0, -10.0))
    robot, board = FakeRobot(known), Blackboard()
    find = leaf(robot, board)
    find.tick_once()
    assert find.status is Status.FAILURE
    assert "shows only 0.00 m² of new area" in find.feedback_message


def test_a_waypoint_in_an_obstacle_is_refused_unless_a_shorter_stride_fits() -> None:
    grid = endless_floor(Pose2(0, 0, 0))
    cells = grid.cells.copy()
    cells[70:90, 93:98] = OCCUPIED  # a bar 1.3 m ahead that the lidar looks over
    robot, board = FakeRobot(OccupancyGrid(cells, 0.1, grid.origin_xy)), Blackboard()
    literal = leaf(robot, board)
    literal.tick_once()
    assert "clear at the waypoint, needs 0.27 m" in literal.feedback_message
    shorter = leaf(robot, board, min_stride=0.6)
    shorter.tick_once()
    assert shorter.status is Status.SUCCESS
    assert shorter.goal.position[0] < 1.1


def test_without_a_scan_nothing_is_found() -> None:
    robot, board = FakeRobot(endless_floor(Pose2(0, 0, 0))), Blackboard()
    robot.latest_scan = None
    find = leaf(robot, board)
    find.tick_once()
    assert find.feedback_message == "no scan yet"
