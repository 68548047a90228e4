import numpy as np
import pytest
from numpy.typing import NDArray

from explore_bt.behaviours import MakeWay
from explore_bt.errors import NoPath
from explore_bt.interfaces import ControlStatus, HeldBy
from explore_bt.testing.fake_robot import FakeRobot, open_floor
from explore_bt.tree import Blackboard, Status
from explore_bt.types import Mate, MovingObstacle, Pose2, Twist2, Waypoint

COMING = MovingObstacle(1, (2.5, 0.0), (-1.0, 0.0), 0.25, 0.0)
GONE = MovingObstacle(1, (-1.2, 0.0), (-1.0, 0.0), 0.25, 0.0)


@pytest.fixture
def robot() -> FakeRobot:
    robot = FakeRobot(open_floor())
    robot.pilot.held_by, robot.moving = HeldBy.SOMEONE, (COMING,)
    return robot


def make_way(robot: FakeRobot, **bindings: object) -> MakeWay:
    board = Blackboard()
    board.write("goal", Waypoint(Pose2(3.0, 0.0, 0.0)))
    leaf = MakeWay("make way", robot, board, bindings)
    leaf.tick_once()
    return leaf


def test_it_steps_off_the_course_waits_and_goes_on(robot: FakeRobot) -> None:
    leaf = make_way(robot)
    assert leaf.status is Status.RUNNING
    robot.pose = robot.pilot.followed[0].goal
    assert abs(robot.pose.y) > 0.5
    robot.pilot.report(ControlStatus.ARRIVED)
    leaf.tick_once()
    assert leaf.status is Status.RUNNING  # there, but still someone comes
    robot.moving = (GONE,)
    leaf.tick_once()
    assert leaf.status is Status.SUCCESS


def test_with_nobody_in_the_way_it_is_no_remedy(robot: FakeRobot) -> None:
    robot.moving, robot.pilot.held_by = (), HeldBy.OBSTACLE
    leaf = make_way(robot)
    assert leaf.status is Status.FAILURE
    assert leaf.feedback_message == ""  # no reason for the failure of the tree


def test_it_does_not_wait_for_ever(robot: FakeRobot) -> None:
    leaf = make_way(robot, patience=5.0)
    robot.time_s = 5.1
    leaf.tick_once()
    assert leaf.status is Status.SUCCESS


def test_without_a_way_aside_it_waits_where_it_is(robot: FakeRobot) -> None:
    robot.refusal = NoPath("no passage wide enough")
    leaf = make_way(robot)
    assert leaf.status is Status.RUNNING
    assert not robot.pilot.followed
    robot.moving = ()
    leaf.tick_once()
    assert leaf.status is Status.SUCCESS


def test_for_one_goal_it_stands_aside_so_often_and_no_more(robot: FakeRobot) -> None:
    leaf = make_way(robot, chances=2, patience=0.0)
    for expected in (Status.SUCCESS, Status.FAILURE):
        leaf.tick_once()
        assert leaf.status is expected
    leaf.blackboard.write("goal", Waypoint(Pose2(-3.0, 2.0, 0.0)))
    leaf.tick_once()
    assert leaf.status is Status.SUCCESS


def test_cut_off_it_leaves_a_robot_that_comes_to_rest(robot: FakeRobot) -> None:
    leaf = make_way(robot)
    before = robot.pilot.holds
    leaf.stop(Status.INVALID)
    assert robot.pilot.holds == before + 1
    assert np.isfinite(robot.pilot.followed[0].poses).all()


COMES = np.column_stack((np.arange(1.0, -3.0, -0.2), np.zeros(20)))
NOWHERE = np.empty((0, 2))


def held_for(robot: FakeRobot, name: str, ahead: NDArray[np.float64]) -> None:
    robot.pilot.held_by, robot.pilot.in_the_way, robot.moving = HeldBy.MATE, name, ()
    pose = Pose2(0.8, 0.0, 3.14)
    robot.team.mates = (Mate(name, 0.0, 0.1, pose, Twist2(), 0.25, 0.5, np.array([pose.xy]), ahead),)


def test_it_lets_a_mate_pass_whose_way_is_known(robot: FakeRobot) -> None:
    held_for(robot, "ada", COMES)
    leaf = make_way(robot)
    place = robot.pilot.followed[0].goal
    assert np.hypot(*(COMES - place.xy).T).min() > 0.6
    robot.pose = place
    robot.pilot.report(ControlStatus.ARRIVED)
    leaf.tick_once()
    assert leaf.status is Status.RUNNING
    robot.team.mates = ()
    leaf.tick_once()
    assert leaf.status is Status.SUCCESS


@pytest.mark.parametrize(("name", "waits_s"), [("ada", 4.0), ("zoe", 2.0)])
def test_a_mate_that_goes_nowhere_is_not_waited_for(robot: FakeRobot, name: str, waits_s: float) -> None:
    """Of two that wait for each other the one that goes first begins."""
    held_for(robot, name, NOWHERE)
    robot.name = robot.team.name = "robot"
    leaf = make_way(robot)
    robot.pilot.report(ControlStatus.ARRIVED)
    ended_s = None
    for _ in range(100):
        robot.time_s += 0.1
        leaf.tick_once()
        if leaf.status is Status.SUCCESS:
            ended_s = robot.time_s
            break
    assert ended_s is not None
    assert ended_s == pytest.approx(waits_s, abs=0.3)
