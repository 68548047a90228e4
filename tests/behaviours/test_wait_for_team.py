from dataclasses import replace

import numpy as np
import pytest

from explore_bt.behaviours import WaitForTeam
from explore_bt.testing.fake_robot import FakeRobot, open_floor
from explore_bt.tree import Blackboard, Status
from explore_bt.types import UNKNOWN, Doing, Mate, Pose2, Twist2


def mate(doing: Doing, name: str = "bob") -> Mate:
    nowhere = np.empty((0, 2))
    return Mate(name, 0.0, 0.0, Pose2(3, 0, 0), Twist2(), 0.25, 0.5, nowhere, nowhere, (), doing)


@pytest.fixture
def robot() -> FakeRobot:
    robot = FakeRobot(open_floor(4.0))
    cells = robot.grid.cells.copy()
    cells[:, 20:] = UNKNOWN
    robot.grid = replace(robot.grid, cells=cells)
    return robot


def waiting(robot: FakeRobot) -> WaitForTeam:
    leaf = WaitForTeam("wait", robot, Blackboard())
    leaf.tick_once()
    return leaf


def know_everything(robot: FakeRobot) -> None:
    robot.grid = open_floor(4.0)


def test_alone_there_is_nothing_to_wait_for(robot: FakeRobot) -> None:
    assert waiting(robot).status is Status.FAILURE


def test_it_waits_idle_and_without_claims_while_somebody_is_at_work(robot: FakeRobot) -> None:
    robot.team.mates = (mate(Doing.AT_WORK), mate(Doing.IDLE, "carl"))
    robot.team.claim([(1.0, 1.0)])
    leaf = waiting(robot)
    assert leaf.status is Status.RUNNING
    assert (robot.team.doing, robot.team.claims) == (Doing.IDLE, ())
    assert leaf.feedback_message == "at work: bob"


def test_it_looks_again_once_more_is_known_but_not_every_moment(robot: FakeRobot) -> None:
    robot.team.mates = (mate(Doing.AT_WORK),)
    leaf = waiting(robot)
    know_everything(robot)
    robot.time_s = 1.0
    leaf.tick_once()
    assert leaf.status is Status.RUNNING
    robot.time_s = 2.0
    leaf.tick_once()
    assert leaf.status is Status.SUCCESS
    assert robot.team.doing is Doing.AT_WORK


def test_when_the_last_one_is_done_the_map_is_looked_through_once_more_if_it_has_grown(
    robot: FakeRobot,
) -> None:
    robot.team.mates = (mate(Doing.AT_WORK),)
    leaf = waiting(robot)
    know_everything(robot)
    robot.team.mates = (mate(Doing.IDLE),)
    leaf.tick_once()
    assert leaf.status is Status.SUCCESS
    leaf.tick_once()
    assert leaf.status is Status.FAILURE, "nothing has come since"


@pytest.mark.parametrize("left", [(), (mate(Doing.PAUSED),)], ids=["silent", "paused"])
def test_it_looks_again_once_somebody_who_was_at_work_is_gone(
    robot: FakeRobot, left: tuple[Mate, ...]
) -> None:
    robot.team.mates = (mate(Doing.AT_WORK), mate(Doing.IDLE, "carl"))
    leaf = waiting(robot)
    robot.team.mates = (*left, mate(Doing.IDLE, "carl"))
    leaf.tick_once()
    assert leaf.status is Status.SUCCESS
    assert robot.team.doing is Doing.AT_WORK
    assert leaf.feedback_message == "bob is silent or paused: look again"
