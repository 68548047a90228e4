import math

import numpy as np
import pytest

from explore_bt.behaviours import BackOut
from explore_bt.interfaces import ControlStatus
from explore_bt.testing.fake_robot import FakeRobot, full_circle_scan, open_floor
from explore_bt.tree import Blackboard, Status
from explore_bt.types import OCCUPIED, OccupancyGrid, Pose2


def dead_end() -> OccupancyGrid:
    """A passage 0.8 m wide along x, from the open floor at x < 0 to an end at x = 2 m."""
    floor = open_floor(10.0, 0.05)
    cells = floor.cells.copy()
    xs = (np.arange(cells.shape[1]) + 0.5) * 0.05 - 5.0
    for row in range(cells.shape[0]):
        y = (row + 0.5) * 0.05 - 5.0
        if abs(y) > 0.4:
            cells[row, xs > 0.0] = OCCUPIED
    cells[:, xs > 2.0] = OCCUPIED
    return OccupancyGrid(cells, 0.05, floor.origin_xy)


@pytest.fixture
def robot() -> FakeRobot:
    robot = FakeRobot(dead_end(), Pose2(1.6, 0.02, 0.0))
    robot.driven = [Pose2(-2.0 + 0.03 * i, 0.02 * math.sin(i / 9.0), 0.0) for i in range(120)]
    return robot


def test_it_drives_its_own_track_back_to_where_there_is_room(robot: FakeRobot) -> None:
    leaf = BackOut("out", robot, Blackboard())
    leaf.tick_once()
    path = robot.pilot.followed[0]
    assert leaf.status is Status.RUNNING
    assert path.poses[0, :2] == pytest.approx(robot.pose.xy)
    assert -0.6 < path.goal.x < 0.0  # the first place outside with 0.4 m all round
    assert path.clearance_m[-1] >= 0.4
    driven = np.array([pose.xy for pose in robot.driven])
    for place in path.poses[:, :2]:
        assert np.hypot(*(driven - place).T).min() < 0.035
    robot.pilot.report(ControlStatus.ARRIVED)
    leaf.tick_once()
    assert leaf.status is Status.SUCCESS


def test_where_there_is_room_at_once_it_still_goes_a_little(robot: FakeRobot) -> None:
    robot.grid = open_floor()
    leaf = BackOut("out", robot, Blackboard(), {"at_least": 0.7})
    leaf.tick_once()
    assert robot.pilot.followed[0].length_m == pytest.approx(0.7, abs=0.06)


def test_where_there_is_room_it_need_not_move_at_all(robot: FakeRobot) -> None:
    robot.grid = open_floor()
    leaf = BackOut("out", robot, Blackboard(), {"at_least": 0.0})
    leaf.tick_once()
    words = "there is room here: 0.65 m clear, 0.40 m are enough"
    assert (leaf.status, leaf.feedback_message) == (Status.SUCCESS, words)
    assert not robot.pilot.followed


def test_what_only_the_scan_sees_leaves_no_room(robot: FakeRobot) -> None:
    robot.grid = open_floor()
    ranges = np.full(360, np.inf)
    ranges[40] = 0.27
    robot.latest_scan = full_circle_scan(ranges)
    leaf = BackOut("out", robot, Blackboard(), {"at_least": 0.0})
    leaf.tick_once()
    assert leaf.status is Status.RUNNING
    assert robot.pilot.followed[0].length_m == pytest.approx(0.5, abs=0.06)


def test_without_room_it_goes_as_far_as_allowed(robot: FakeRobot) -> None:
    leaf = BackOut("out", robot, Blackboard(), {"at_most": 1.0})
    leaf.tick_once()
    assert robot.pilot.followed[0].length_m == pytest.approx(1.2, abs=0.2)


def test_a_robot_that_has_not_moved_has_no_way_back(robot: FakeRobot) -> None:
    robot.driven = []
    leaf = BackOut("out", robot, Blackboard())
    leaf.tick_once()
    assert (leaf.status, leaf.feedback_message) == (Status.FAILURE, "no way back: nothing driven yet")
    assert not robot.pilot.followed


@pytest.mark.parametrize("by_controller", [False, True])
def test_held_on_the_way_it_fails_and_comes_to_rest(robot: FakeRobot, by_controller: bool) -> None:
    leaf = BackOut("out", robot, Blackboard(), {"patience": 3.0})
    leaf.tick_once()
    robot.pilot.gate_reason = "a chair"
    if by_controller:
        robot.pilot.report(ControlStatus.STUCK, "no headway")
    else:
        robot.pilot.blocked_s = 3.1
    leaf.tick_once()
    assert leaf.status is Status.FAILURE
    assert leaf.feedback_message == f"held on the way back: {'no headway' if by_controller else 'a chair'}"
    assert robot.pilot.holds == 1
