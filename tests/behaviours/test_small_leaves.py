import math

import numpy as np
import pytest

from explore_bt.behaviours import (
    LEAVES,
    ChooseHome,
    ChoosePlace,
    ClearMap,
    GivenUp,
    GiveUpGoal,
    RecordWaypoint,
    ResetHalfPlanes,
    StandUp,
    StopRequested,
    TakeBack,
    Turn,
    Wait,
    WaitUntilLocalised,
    WatchProgress,
)
from explore_bt.interfaces import ControlStatus
from explore_bt.testing.fake_robot import FakeRobot, open_floor
from explore_bt.tree import Blackboard, Leaf, Status
from explore_bt.types import (
    FREE,
    UNKNOWN,
    BodyFault,
    BodyFaultKind,
    Estimate,
    Health,
    OccupancyGrid,
    Pose2,
    Waypoint,
)


@pytest.fixture
def robot() -> FakeRobot:
    return FakeRobot(open_floor(), Pose2(1.0, 2.0, 0.5))


@pytest.fixture
def board() -> Blackboard:
    return Blackboard()


@pytest.mark.parametrize("leaf", LEAVES)
def test_every_leaf_documents_itself_and_its_ports(leaf: type[Leaf]) -> None:
    assert leaf.__doc__
    assert leaf.type_key == leaf.type_key.lower()
    for port in (*leaf.inputs.values(), *leaf.outputs.values()):
        assert port.doc


def test_recording_remembers_the_goal_and_its_half_plane(robot: FakeRobot, board: Blackboard) -> None:
    board.write("goal", Waypoint(Pose2(3.0, 4.0, math.pi / 2)))
    RecordWaypoint("record", robot, board).tick_once()
    assert [w.position for w in board["visited"]] == [(3.0, 4.0)]
    assert board["half_planes"].contains((9.0, 4.5))
    assert not board["half_planes"].contains((3.0, 3.5))


def test_recording_here_remembers_where_the_robot_stands(robot: FakeRobot, board: Blackboard) -> None:
    RecordWaypoint("record", robot, board, {"place": "here"}).tick_once()
    assert board["visited"][0].pose == robot.pose


def test_a_reset_leaves_no_constraint(robot: FakeRobot, board: Blackboard) -> None:
    RecordWaypoint("record", robot, board, {"place": "here"}).tick_once()
    ResetHalfPlanes("reset", robot, board).tick_once()
    assert board["half_planes"].contains((-99.0, -99.0))


def test_home_is_where_the_mission_began(robot: FakeRobot, board: Blackboard) -> None:
    robot.pose = Pose2(5.0, 5.0, 0.0)
    ChooseHome("home", robot, board).tick_once()
    assert board["goal"].pose == Pose2(1.0, 2.0, 0.5)


def test_an_errand_goes_to_the_place_that_is_named(robot: FakeRobot, board: Blackboard) -> None:
    ChoosePlace("place", robot, board, {"x": 3.0, "y": -2.0, "yaw": 1.0}).tick_once()
    assert board["goal"].pose == Pose2(3.0, -2.0, 1.0)


def test_the_map_around_the_robot_is_cleared(robot: FakeRobot, board: Blackboard) -> None:
    leaf = ClearMap("clear", robot, board, {"radius": 1.5})
    leaf.tick_once()
    assert leaf.status is Status.SUCCESS
    assert robot.cleared == [1.5]


def test_a_turn_is_a_path_of_one_pose_in_the_new_direction(robot: FakeRobot, board: Blackboard) -> None:
    leaf = Turn("turn", robot, board)
    leaf.tick_once()
    assert leaf.status is Status.RUNNING
    pose = robot.pilot.followed[0].goal
    assert pose.xy == robot.pose.xy
    assert math.cos(pose.yaw_rad - robot.pose.yaw_rad) == pytest.approx(-1.0)
    robot.pilot.report(ControlStatus.ARRIVED)
    leaf.tick_once()
    assert leaf.status is Status.SUCCESS


def test_a_turn_that_does_not_get_on_fails_and_holds(robot: FakeRobot, board: Blackboard) -> None:
    leaf = Turn("turn", robot, board)
    leaf.tick_once()
    robot.pilot.report(ControlStatus.STUCK, "no progress for 5 s")
    leaf.tick_once()
    assert leaf.status is Status.FAILURE
    assert robot.pilot.holds == 1


def test_waiting_takes_mission_time(robot: FakeRobot, board: Blackboard) -> None:
    leaf = Wait("wait", robot, board, {"duration": 2.0})
    statuses = []
    for robot.time_s in (0.0, 1.0, 1.9, 2.0):
        leaf.tick_once()
        statuses.append(leaf.status)
    assert statuses == [Status.RUNNING] * 3 + [Status.SUCCESS]


def test_the_stop_flag_is_a_condition(robot: FakeRobot, board: Blackboard) -> None:
    leaf = StopRequested("stop?", robot, board)
    leaf.tick_once()
    assert leaf.status is Status.FAILURE
    robot.stop_requested = True
    leaf.tick_once()
    assert leaf.status is Status.SUCCESS


def floor_of(cells: int) -> OccupancyGrid:
    grid = np.full((100, 100), UNKNOWN, dtype=np.int8)
    grid.ravel()[:cells] = FREE
    return OccupancyGrid(grid, 0.1, (0.0, 0.0))


def test_a_live_lock_is_named_after_as_many_decisions_as_were_allowed(
    robot: FakeRobot, board: Blackboard
) -> None:
    leaf = WatchProgress("watch", robot, board, {"decisions": 3})
    robot.grid = floor_of(1000)
    statuses = []
    for _ in range(4):
        leaf.tick_once()
        statuses.append(leaf.status)
    assert statuses == [Status.SUCCESS] * 3 + [Status.FAILURE]
    assert leaf.feedback_message.startswith("live-lock: 3 decisions brought 0.00 m² of new floor")


def test_new_floor_is_progress(robot: FakeRobot, board: Blackboard) -> None:
    leaf = WatchProgress("watch", robot, board, {"decisions": 3})
    for k in range(20):
        robot.grid = floor_of(1000 + 30 * k)
        leaf.tick_once()
        assert leaf.status is Status.SUCCESS


def test_a_lost_slam_is_waited_for_and_then_given_up(robot: FakeRobot, board: Blackboard) -> None:
    leaf = WaitUntilLocalised("localised", robot, board, {"patience": 2.0})
    leaf.tick_once()
    assert leaf.status is Status.SUCCESS
    robot.estimate = lambda: Estimate(0.0, robot.pose, health=Health.LOST, reason="few inliers")
    statuses = []
    for robot.time_s in (1.0, 2.0, 3.5):
        leaf.tick_once()
        statuses.append(leaf.status)
    assert statuses == [Status.RUNNING, Status.RUNNING, Status.FAILURE]
    assert "few inliers" in leaf.feedback_message


def test_an_unreached_goal_is_taken_back_as_often_as_allowed(robot: FakeRobot, board: Blackboard) -> None:
    leaf = TakeBack("take back", robot, board, {"chances": 2})
    leaf.tick_once()
    assert leaf.status is Status.FAILURE  # there was nothing
    statuses = []
    for x in (1.0, 1.1, 1.2):  # as good as the same place
        board.write("given_up", (GivenUp((x, 1.0), "no_path"),))
        leaf.tick_once()
        statuses.append(leaf.status)
    assert statuses == [Status.SUCCESS, Status.SUCCESS, Status.FAILURE]
    board.write("given_up", (GivenUp((1.2, 1.0), "no_path"), GivenUp((3.0, 1.0), "no_path")))
    leaf.tick_once()
    assert [place.position for place in board["given_up"]] == [(1.2, 1.0)]


def test_scraps_and_what_was_looked_at_in_vain_stay_given_up(robot: FakeRobot, board: Blackboard) -> None:
    seen = GivenUp((2.0, 2.0), "still 0.3 m² unknown", was_seen=True)
    scrap = GivenUp((3.0, 2.0), "held", gain_m2=0.2)
    robot.avoid((1.0, 1.0))
    board.write("given_up", (GivenUp((1.0, 1.0), "held", gain_m2=0.4), seen, scrap))
    TakeBack("take back", robot, board, {"at_least": 0.3}).tick_once()
    assert board["given_up"] == (seen, scrap)
    assert robot.avoided == []


def test_giving_up_writes_place_reason_and_what_was_expected(robot: FakeRobot, board: Blackboard) -> None:
    board.write("goal", Waypoint(Pose2(1.0, 2.0, 0.0), expected_gain_m2=0.4))
    board.write("failure", "held")
    leaf = GiveUpGoal("give up", robot, board)
    leaf.tick_once()
    assert leaf.feedback_message == "(1.0, 2.0) is given up: held"
    assert board["given_up"] == (GivenUp((1.0, 2.0), "held", gain_m2=0.4),)


FALLEN = BodyFault(BodyFaultKind.FALLEN, "the robot has fallen")


def test_a_body_that_can_drive_is_left_alone(robot: FakeRobot, board: Blackboard) -> None:
    leaf = StandUp("stand up", robot, board)
    leaf.tick_once()
    assert leaf.status is Status.SUCCESS
    assert robot.pilot.recoveries == 0


def test_a_fallen_robot_is_helped_up_once_and_waited_for(robot: FakeRobot, board: Blackboard) -> None:
    leaf = StandUp("stand up", robot, board)
    robot.pilot.body_fault = FALLEN
    for robot.time_s in (0.0, 1.0):
        leaf.tick_once()
        assert leaf.status is Status.RUNNING
    robot.pilot.body_fault = BodyFault(BodyFaultKind.RECOVERING, "it is being stood up")
    leaf.tick_once()
    assert robot.pilot.recoveries == 1
    assert leaf.feedback_message == "it is being stood up, for 1 s; is helped up"
    robot.pilot.body_fault = None
    leaf.tick_once()
    assert leaf.status is Status.SUCCESS


def test_a_robot_that_falls_again_and_again_is_given_up(robot: FakeRobot, board: Blackboard) -> None:
    leaf = StandUp("stand up", robot, board, {"times": 2, "patience": 5.0})
    for _ in range(2):
        robot.pilot.body_fault = FALLEN
        leaf.tick_once()
        robot.pilot.body_fault = None
        leaf.tick_once()
    robot.pilot.body_fault = FALLEN
    leaf.tick_once()
    robot.time_s += 5.0
    leaf.tick_once()
    assert leaf.status is Status.FAILURE
    assert robot.pilot.recoveries == 2
    assert "helped up 2 times already" in leaf.feedback_message


def test_nobody_comes_to_a_robot_that_cannot_get_up(robot: FakeRobot, board: Blackboard) -> None:
    leaf = StandUp("stand up", robot, board, {"patience": 5.0})
    robot.pilot.body_fault, robot.pilot.can_recover = FALLEN, False
    leaf.tick_once()
    robot.time_s = 6.0
    leaf.tick_once()
    assert leaf.status is Status.FAILURE
    assert "cannot get up by itself" in leaf.feedback_message
