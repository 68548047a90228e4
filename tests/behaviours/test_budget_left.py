from __future__ import annotations

import pytest

from explore_bt.behaviours import BudgetLeft
from explore_bt.errors import NoPath
from explore_bt.testing.fake_robot import FakeRobot, open_floor
from explore_bt.tree import Blackboard, Status
from explore_bt.types import Budget, Pose2


@pytest.fixture
def robot() -> FakeRobot:
    """Six metres from home."""
    robot = FakeRobot(open_floor(), Pose2(0.0, 0.0, 0.0))
    robot.pose = Pose2(6.0, 0.0, 0.0)
    return robot


@pytest.fixture
def board() -> Blackboard:
    return Blackboard()


def leaf(robot: FakeRobot, board: Blackboard, **ports: object) -> BudgetLeft:
    return BudgetLeft("budget", robot, board, {"pace": 0.2, "spare": 0.2, **ports})


def seconds(left: float) -> tuple[Budget, ...]:
    return (Budget("time", "s", 600.0, left, per_s=1.0),)


def test_without_limits_there_is_always_enough(robot: FakeRobot, board: Blackboard) -> None:
    node = leaf(robot, board)
    node.tick_once()
    assert node.status is Status.SUCCESS


@pytest.mark.parametrize(("left", "expected"), [(36.5, Status.SUCCESS), (35.5, Status.FAILURE)])
def test_it_fails_once_the_planned_way_home_takes_what_is_left(
    robot: FakeRobot, board: Blackboard, left: float, expected: Status
) -> None:
    robot.limited = seconds(left)
    node = leaf(robot, board)
    node.tick_once()  # 6 m at 0.2 m/s and a fifth more
    assert node.status is expected
    assert ("over_budget" in board) is (expected is Status.FAILURE)


def test_what_ran_short_is_named(robot: FakeRobot, board: Blackboard) -> None:
    robot.limited = (Budget("distance", "m", 80.0, 7.0, per_m=1.0), *seconds(500.0))
    leaf(robot, board).tick_once()
    assert board["over_budget"] == (
        "turned home: the way of 6.0 m takes 7 m, left of the distance budget are 7 of 80 m"
    )


def test_a_robot_that_stands_at_home_may_go_on_to_the_last(robot: FakeRobot, board: Blackboard) -> None:
    robot.pose = robot.home
    robot.limited = seconds(0.5)
    node = leaf(robot, board)
    node.tick_once()
    assert node.status is Status.SUCCESS


def test_nothing_is_planned_while_there_is_plenty(robot: FakeRobot, board: Blackboard) -> None:
    robot.limited = seconds(500.0)
    robot.refusal = NoPath("a plan was asked for")
    node = leaf(robot, board)
    node.tick_once()
    assert node.status is Status.SUCCESS
    assert node.feedback_message == ""


def test_where_no_way_is_found_the_last_one_counts_and_what_was_driven_since(
    robot: FakeRobot, board: Blackboard
) -> None:
    node = leaf(robot, board, pace=1.0, spare=0.0)
    robot.limited = seconds(8.5)
    node.tick_once()
    assert node.status is Status.SUCCESS  # 6 m planned
    robot.refusal = NoPath("none")
    robot.time_s, robot.distance_m = 5.0, 2.0
    node.tick_once()
    assert node.status is Status.SUCCESS  # 6 + 2 m
    robot.time_s, robot.distance_m = 10.0, 3.0
    node.tick_once()
    assert node.status is Status.FAILURE  # 6 + 3 m


def test_without_any_plan_three_times_the_straight_way_counts(robot: FakeRobot, board: Blackboard) -> None:
    robot.refusal = NoPath("none")
    robot.limited = seconds(17.9)
    node = leaf(robot, board, pace=1.0, spare=0.0)
    node.tick_once()
    assert node.status is Status.FAILURE
