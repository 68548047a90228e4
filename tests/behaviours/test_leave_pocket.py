import numpy as np
import pytest

from explore_bt.behaviours import LeavePocket
from explore_bt.interfaces import ControlStatus
from explore_bt.testing.fake_robot import FakeRobot, open_floor
from explore_bt.tree import Blackboard, Status
from explore_bt.types import OCCUPIED, OccupancyGrid, Pose2


def two_rooms(door_m: float) -> OccupancyGrid:
    """A large room at x < 1 m and a small one beyond, with a door between them at y = 0."""
    floor = open_floor(8.0, 0.05)
    cells = floor.cells.copy()
    wall = floor.cell_of(1.0, 0.0)[1]
    ys = floor.origin_xy[1] + 0.05 * (np.arange(cells.shape[0]) + 0.5)
    cells[np.abs(ys) > door_m / 2, wall] = OCCUPIED
    return OccupancyGrid(cells, 0.05, floor.origin_xy)


@pytest.fixture
def robot() -> FakeRobot:
    robot = FakeRobot(two_rooms(0.35), Pose2(2.5, 0.5, 0.0))
    robot.driven = [
        *(Pose2(-2.0 + 0.05 * i, 0.01, 0.0) for i in range(80)),
        *(Pose2(2.0 + 0.05 * i, 0.05 * i, 0.8) for i in range(10)),
    ]
    return robot


def test_it_goes_back_through_the_door_that_has_become_too_narrow(robot: FakeRobot) -> None:
    leaf = LeavePocket("leave", robot, Blackboard())
    leaf.tick_once()
    path = robot.pilot.followed[0]
    assert leaf.status is Status.RUNNING
    assert path.poses[0, :2] == pytest.approx(robot.pose.xy)
    assert 0.3 < path.goal.x < 1.0
    assert path.clearance_m[-1] >= robot.footprint_radius_m
    driven = np.array([pose.xy for pose in (*robot.driven, robot.pose)])
    for place in path.poses[:, :2]:
        assert np.hypot(*(driven - place).T).min() < 0.05
    robot.pilot.report(ControlStatus.ARRIVED)
    leaf.tick_once()
    assert leaf.status is Status.SUCCESS


@pytest.mark.parametrize("door_m", [0.35, 2.0])
def test_on_the_larger_piece_there_is_nothing_to_leave(robot: FakeRobot, door_m: float) -> None:
    robot.grid = two_rooms(door_m)
    if door_m < 1.0:
        robot.pose = Pose2(-2.0, 0.5, 0.0)
    leaf = LeavePocket("leave", robot, Blackboard())
    leaf.tick_once()
    assert leaf.status is Status.FAILURE
    assert robot.pilot.followed == []


def test_a_held_robot_says_so(robot: FakeRobot) -> None:
    leaf = LeavePocket("leave", robot, Blackboard(), {"patience": 1.0})
    leaf.tick_once()
    robot.pilot.blocked_s = 2.0
    robot.pilot.gate_reason = "something stands there"
    leaf.tick_once()
    assert leaf.status is Status.FAILURE
    assert leaf.feedback_message == "held on the way back: something stands there"
