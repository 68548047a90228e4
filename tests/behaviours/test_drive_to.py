import numpy as np
import pytest
from explore_bt_teams import Greedy

from explore_bt.behaviours import DriveTo
from explore_bt.errors import GoalBlocked, NoPath
from explore_bt.interfaces import ControlStatus, HeldBy, PluginOptions
from explore_bt.testing.fake_robot import FakeRobot, open_floor
from explore_bt.tree import Blackboard, Status
from explore_bt.types import (
    FREE,
    OCCUPIED,
    UNKNOWN,
    Mate,
    MovingObstacle,
    OccupancyGrid,
    Path,
    Pose2,
    Twist2,
    Waypoint,
)

AHEAD = Waypoint(Pose2(3.0, 0.0, 0.0))


def drive(robot: FakeRobot, goal: Waypoint = AHEAD, **bindings: object) -> DriveTo:
    board = Blackboard()
    board.write("goal", goal)
    leaf = DriveTo("drive", robot, board, bindings)
    leaf.tick_once()
    return leaf


def test_a_drive_ends_when_the_controller_arrives() -> None:
    robot = FakeRobot(open_floor())
    leaf = drive(robot)
    assert leaf.status is Status.RUNNING
    assert len(robot.pilot.followed) == 1
    robot.pilot.report(ControlStatus.ARRIVED)
    leaf.tick_once()
    assert leaf.status is Status.SUCCESS


def test_a_planners_no_is_a_failure_with_its_code() -> None:
    robot = FakeRobot(open_floor())
    robot.refusal = NoPath("no passage wide enough")
    leaf = drive(robot)
    assert leaf.status is Status.FAILURE
    assert leaf.blackboard["failure"] == "no_path"
    assert leaf.feedback_message == "no path: no passage wide enough"
    assert robot.pilot.holds == 1


def test_a_robot_held_by_the_gate_plans_anew_and_gives_up_in_the_end() -> None:
    robot = FakeRobot(open_floor())
    leaf = drive(robot, patience=2.0, replans=2)
    robot.pilot.blocked_s = 2.5
    for _ in range(2):
        leaf.tick_once()
        assert leaf.status is Status.RUNNING
    leaf.tick_once()
    assert leaf.status is Status.FAILURE
    assert len(robot.pilot.followed) == 3
    assert leaf.blackboard["failure"] == "held"
    assert len(robot.avoided) == 1  # the second hold closed the place ahead


SOMEONE_NEAR = MovingObstacle(1, (1.0, 0.0), (0.0, 0.5), 0.25, 0.0)


def test_someone_in_the_way_is_waited_for_and_then_left_to_the_tree() -> None:
    robot = FakeRobot(open_floor())
    leaf = drive(robot, patience=2.0, give_way=4.0)
    robot.pilot.held_by, robot.moving = HeldBy.SOMEONE, (SOMEONE_NEAR,)
    robot.pilot.blocked_s = 3.0
    leaf.tick_once()
    assert leaf.status is Status.RUNNING
    robot.pilot.blocked_s = 4.1
    leaf.tick_once()
    assert leaf.status is Status.FAILURE
    assert leaf.blackboard["failure"] == "someone_in_the_way"
    assert len(robot.pilot.followed) == 1
    assert not robot.avoided  # a person is no tight place


def test_a_controller_that_gave_up_because_of_people_is_sent_on_along_the_same_path() -> None:
    robot = FakeRobot(open_floor())
    leaf = drive(robot)
    robot.moving = (SOMEONE_NEAR,)
    robot.pilot.report(ControlStatus.STUCK, "waiting for something that moves")
    leaf.tick_once()
    assert leaf.status is Status.RUNNING
    assert robot.pilot.output.status is ControlStatus.RUNNING
    first, again = robot.pilot.followed
    assert again is first


def test_a_way_that_someone_stands_in_is_asked_for_again() -> None:
    robot = FakeRobot(open_floor())
    robot.refusal, robot.moving = NoPath("no passage wide enough"), (SOMEONE_NEAR,)
    leaf = drive(robot)
    assert leaf.status is Status.RUNNING
    robot.refusal, robot.moving, robot.time_s = None, (), 1.5
    leaf.tick_once()
    assert leaf.status is Status.RUNNING
    assert len(robot.pilot.followed) == 1


@pytest.mark.parametrize(("x", "expected"), [(3.3, Status.RUNNING), (-2.0, Status.FAILURE)])
def test_a_goal_that_is_blocked_is_waited_for_only_if_someone_is_there(x: float, expected: Status) -> None:
    robot = FakeRobot(open_floor())
    robot.refusal = GoalBlocked("the goal has 0.03 m of clearance")
    robot.moving = (MovingObstacle(1, (x, 0.0), (0.0, 0.0), 0.25, 0.0),)
    assert drive(robot).status is expected


def test_an_obstacle_that_appears_on_the_way_ahead_brings_a_new_plan() -> None:
    robot = FakeRobot(open_floor())
    leaf = drive(robot)
    leaf.tick_once()
    cells = robot.grid.cells.copy()
    row, col = robot.grid.cell_of(2.0, 0.0)
    cells[row, col] = OCCUPIED
    robot.grid = OccupancyGrid(cells, robot.grid.resolution_m, robot.grid.origin_xy, revision=1)
    leaf.tick_once()
    assert len(robot.pilot.followed) == 2


def test_an_obstacle_behind_the_robot_does_not() -> None:
    robot = FakeRobot(open_floor())
    leaf = drive(robot)
    robot.pose = Pose2(2.0, 0.0, 0.0)
    cells = robot.grid.cells.copy()
    row, col = robot.grid.cell_of(0.5, 0.0)
    cells[row, col] = OCCUPIED
    robot.grid = OccupancyGrid(cells, robot.grid.resolution_m, robot.grid.origin_xy, revision=1)
    leaf.tick_once()
    assert len(robot.pilot.followed) == 1


def test_a_goal_that_shows_nothing_new_any_more_is_not_driven_to_the_end() -> None:
    known = OccupancyGrid(np.full((300, 300), FREE, dtype=np.int8), 0.1, (-15.0, -15.0))
    robot = FakeRobot(known)
    leaf = drive(robot, until_seen=0.1)
    assert leaf.status is Status.RUNNING
    robot.time_s = 1.5
    leaf.tick_once()
    assert leaf.status is Status.SUCCESS
    assert "seen from afar" in leaf.feedback_message
    assert leaf.blackboard["reached"].pose == robot.pose


@pytest.mark.parametrize(("promise_m2", "goes_on"), [(0.2, True), (2.0, False)])
def test_a_scrap_once_begun_is_driven_to(promise_m2: float, goes_on: bool) -> None:
    """Some of the unknown is left to be seen, less than ``until_seen``, and the robot has driven a metre."""
    cells = np.full((300, 300), FREE, dtype=np.int8)
    cells[148:152, 172:174] = UNKNOWN
    robot = FakeRobot(OccupancyGrid(cells, 0.1, (-15.0, -15.0)))
    goal = Waypoint(Pose2(2.0, 0.0, 0.0), "view", expected_gain_m2=promise_m2)
    leaf = drive(robot, goal, until_seen=0.3, look_again=1.0)
    robot.time_s, robot.distance_m = 1.5, 1.1
    leaf.tick_once()
    assert (leaf.status is Status.RUNNING) is goes_on


def test_a_drive_that_is_cut_off_holds_the_robot() -> None:
    robot = FakeRobot(open_floor())
    leaf = drive(robot)
    leaf.stop(Status.INVALID)
    assert robot.pilot.holds == 1


def test_a_drive_that_is_to_look_again_ends_after_so_much_way() -> None:
    robot = FakeRobot(open_floor())
    leaf = drive(robot, look_again=1.0)
    robot.distance_m = 0.9
    leaf.tick_once()
    assert leaf.status is Status.RUNNING
    robot.distance_m, robot.pose = 1.0, Pose2(1.0, 0.0, 0.0)
    leaf.tick_once()
    assert leaf.status is Status.SUCCESS
    assert leaf.blackboard["reached"].pose == robot.pose
    assert robot.pilot.holds == 0


@pytest.mark.parametrize(("look_again", "status"), [(1.0, Status.SUCCESS), (None, Status.RUNNING)])
def test_a_cut_way_with_a_long_one_around_lets_the_tree_decide_anew(
    look_again: float | None, status: Status
) -> None:
    robot = FakeRobot(open_floor())
    leaf = drive(robot, look_again=look_again)
    robot.plan = lambda goal, via: Path(np.array([[0, 0, 0], [4, 4, 0], [*goal.xy, 0]], float), np.ones(3))
    cells = robot.grid.cells.copy()
    cells[robot.grid.cell_of(2.0, 0.0)] = OCCUPIED
    robot.grid = OccupancyGrid(cells, robot.grid.resolution_m, robot.grid.origin_xy, revision=1)
    leaf.tick_once()
    assert leaf.status is status


def test_a_way_that_someone_cuts_is_waited_for_even_if_it_was_the_only_one() -> None:
    robot = FakeRobot(open_floor())
    leaf = drive(robot, look_again=1.0)
    robot.refusal, robot.moving = NoPath("no passage wide enough"), (SOMEONE_NEAR,)
    cells = robot.grid.cells.copy()
    cells[robot.grid.cell_of(2.0, 0.0)] = OCCUPIED
    robot.grid = OccupancyGrid(cells, robot.grid.resolution_m, robot.grid.origin_xy, revision=1)
    leaf.tick_once()
    assert leaf.status is Status.RUNNING
    assert leaf.feedback_message == "waiting for someone to pass, up to 3 s"
    assert robot.pilot.holds == 1


def test_places_on_the_way_are_passed_in_their_order_and_once() -> None:
    robot = FakeRobot(open_floor())
    asked: list[tuple[tuple[float, float], ...]] = []
    straight = robot.plan
    robot.plan = lambda goal, via: (asked.append(tuple(via)), straight(goal))[1]
    goal = Waypoint(Pose2(4.0, 0.0, 0.0), via=((1.0, 0.0), (2.0, 0.0)))
    leaf = drive(robot, goal, patience=1.0)
    robot.pose = Pose2(1.1, 0.0, 0.0)
    leaf.tick_once()
    robot.pilot.blocked_s = 1.5
    leaf.tick_once()
    assert asked == [((1.0, 0.0), (2.0, 0.0)), ((2.0, 0.0),)]


def test_a_goal_that_is_seen_is_driven_to_while_a_place_on_the_way_is_not() -> None:
    cells = open_floor(12.0, 0.1).cells.copy()
    cells[60:, :60] = UNKNOWN  # seen from the place on the way, hidden from the goal by the wall
    cells[58:, 60] = OCCUPIED
    cells[[0, -1], :] = cells[:, [0, -1]] = OCCUPIED
    robot = FakeRobot(OccupancyGrid(cells, 0.1, (-6.0, -6.0)), Pose2(-4.0, -3.0, 0.0))
    through = Waypoint(Pose2(4.0, 3.0, 0.0), via=((-2.0, -1.0),))
    straight = Waypoint(Pose2(4.0, 3.0, 0.0))
    for goal, status in ((through, Status.RUNNING), (straight, Status.SUCCESS)):
        leaf = drive(robot, goal, until_seen=0.3)
        robot.time_s += 1.5
        leaf.tick_once()
        assert leaf.status is status


@pytest.mark.parametrize(
    ("name", "claimed", "goes_on"),
    [("ada", (4.0, 0.05), False), ("ada", (4.0, 0.3), True), ("zoe", (4.0, 0.0), True)],
    ids=["goes first", "goes elsewhere", "goes second"],
)
def test_a_goal_that_a_mate_has_claimed_at_the_same_time_is_left_to_the_one_that_goes_first(
    name: str, claimed: tuple[float, float], goes_on: bool
) -> None:
    robot = FakeRobot(open_floor(10.0))  # beyond which all is unknown
    robot.team.allocator = Greedy(PluginOptions())
    goal = Waypoint(Pose2(4.0, 0.0, 0.0), "", expected_gain_m2=5.0)
    leaf = drive(robot, goal, until_seen=0.1)
    nowhere = np.empty((0, 2))
    told = (Pose2(3.0, 3.0, 0.0), Twist2(), 0.25, 0.5, nowhere, nowhere, (claimed,))
    robot.team.mates = (Mate(name, 0.0, 0.0, *told),)
    robot.time_s = 1.5
    leaf.tick_once()
    assert leaf.status is (Status.RUNNING if goes_on else Status.SUCCESS)
    assert goes_on or leaf.feedback_message == "left to ada, which is on its way there too"
