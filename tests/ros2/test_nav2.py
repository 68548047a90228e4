"""Goals through NavigateToPose to a stand-in of Nav2 in a process of its own, and through /goal_pose."""

from __future__ import annotations

from tests.ros2 import ros  # isort: skip  # noqa: F401

import importlib
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager
from pathlib import Path

import numpy as np
import pytest
from explore_bt_ros2.driver import Ros2
from explore_bt_ros2.link import Link
from explore_bt_ros2.nav2 import Nav2, Nav2Options
from explore_bt_ros2.options import Ros2Options
from geometry_msgs.msg import PoseStamped, Twist
from rclpy.qos import QoSProfile

from explore_bt.errors import PluginError
from explore_bt.interfaces import ControlOutput, ControlStatus, RobotContext
from explore_bt.testing.controller_contract import require_limits
from explore_bt.types import Estimate, MotionState, Pose2, Twist2, WheelOdometry
from explore_bt.types import Path as Way
from tests.ros2.build_nav2_msgs import build, can_build, preload
from tests.ros2.processes import stand_in_process
from tests.ros2.worlds import HALL, robot_in

DT = 0.05


@pytest.fixture(scope="session")
def nav2_msgs(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """The built definition, on the path of this process."""
    if importlib.util.find_spec("nav2_msgs") is None and not can_build():
        pytest.skip("NavigateToPose cannot be built here: cmake, c++ or the generators' wheels are missing")
    where = build(tmp_path_factory.mktemp("nav2_msgs"))
    sys.path.insert(0, str(where))
    preload(where)
    importlib.invalidate_caches()
    yield where
    sys.path.remove(str(where))


def stand_in(where: Path) -> AbstractContextManager[subprocess.Popen[str]]:
    script = (
        f"import pathlib, sys; sys.path[:0] = [{str(where)!r}, {str(Path(__file__).parent)!r}]\n"
        f"from build_nav2_msgs import preload; preload(pathlib.Path({str(where)!r}))\n"
        "from stand_in_nav2 import main; main()"
    )
    return stand_in_process("-c", script)


class Robot:
    """Driver and controller in a loop; odom is taken for map."""

    def __init__(self, controller: Nav2) -> None:
        self.driver = Ros2(Ros2Options(outputs=False))
        self.driver.setup(RobotContext())
        self.controller = controller
        self.controller.setup(RobotContext(connection=self.driver.connection, limits=self.driver.limits))
        self.pose = Pose2.identity()
        self.motion = MotionState()
        self.outputs: list[ControlOutput] = []
        self.motions = [self.motion]

    def run(self, until: Callable[[ControlOutput], bool], deadline_s: float) -> ControlOutput:
        """Periods until the output says so."""
        clock = self.driver.clock
        end_s = clock.now_s() + deadline_s
        while clock.now_s() < end_s:
            clock.wait_until(clock.now_s() + DT)
            for each in self.driver.read():
                if isinstance(each, WheelOdometry):
                    self.pose = each.T_odom_base
            output = self.controller.step(Estimate(clock.now_s(), self.pose), None, self.motion, DT)
            self.outputs.append(output)
            before, after = self.motion.twist, output.twist
            self.motion = MotionState(
                after,
                (after.linear_mps - before.linear_mps) / DT,
                (after.angular_rps - before.angular_rps) / DT,
            )
            self.motions.append(self.motion)
            self.driver.command(after)
            if until(output):
                return output
        raise AssertionError(f"after {deadline_s} s: {self.outputs[-1]}, at {self.pose}")


@pytest.fixture
def hall(tmp_path: Path) -> Iterator[None]:
    (tmp_path / "hall.yaml").write_text(HALL)
    with robot_in(tmp_path / "hall.yaml", "--wall-time"):
        yield


def way_to(x: float, y: float) -> Way:
    return Way(np.array([[x, y, 0.0]]), np.ones(1))


def is_over(output: ControlOutput) -> bool:
    return output.status is not ControlStatus.RUNNING


def test_without_the_ros2_driver_it_says_what_to_write():
    with pytest.raises(PluginError, match=r"driver: \{use: ros2\}"):
        Nav2(Nav2Options()).setup(RobotContext())


@pytest.mark.slow
def test_nav2_is_given_goals_and_cancels_gives_up_dies_and_comes_back(nav2_msgs, hall):
    robot = Robot(Nav2(Nav2Options()))
    controller = robot.controller
    try:
        controller.follow(way_to(1.0, 0.0))
        away = robot.run(is_over, 8.0)
        assert away.status is ControlStatus.STUCK
        assert "Nav2's action /navigate_to_pose is not there, for 5 s" in away.reason

        with stand_in(nav2_msgs) as server:
            controller.follow(way_to(0.8, 0.2))
            assert robot.run(is_over, 15.0).status is ControlStatus.ARRIVED
            assert robot.pose.distance_to(Pose2(0.8, 0.2, 0.0)) < 0.3
            assert any("m to go" in output.reason for output in robot.outputs)

            controller.follow(way_to(0.0, 60.0))
            gave_up = robot.run(is_over, 5.0)
            assert (gave_up.status, gave_up.reason) == (ControlStatus.STUCK, "Nav2 gave up: error 9003")
            controller.follow(way_to(60.0, 0.0))
            assert robot.run(is_over, 5.0).reason == "Nav2 has rejected the goal"

            controller.follow(way_to(4.0, 0.0))
            robot.run(lambda output: output.twist.linear_mps > 0.2, 8.0)
            controller.hold()
            assert robot.run(is_over, 5.0).status is ControlStatus.IDLE

            controller.follow(way_to(4.0, 0.0))
            robot.run(lambda output: output.twist.linear_mps > 0.2, 8.0)
            server.kill()
            server.wait()
            robot.run(lambda output: output.twist == Twist2() or abs(output.twist.linear_mps) < 1e-3, 3.0)
        controller.follow(way_to(1.5, 0.0))  # the network still believes that the dead one is there
        assert robot.run(is_over, 8.0).reason.startswith("Nav2's action /navigate_to_pose does not answer")
        controller.follow(way_to(1.5, 0.0))
        with stand_in(nav2_msgs):
            assert robot.run(is_over, 20.0).status is ControlStatus.ARRIVED
        require_limits(robot.motions, robot.driver.limits, [DT] * len(robot.motions))
    finally:
        robot.driver.close()


def test_without_nav2_msgs_goals_go_to_goal_pose_and_arrival_is_seen_by_the_pose(hall, monkeypatch):
    find = importlib.util.find_spec
    monkeypatch.setattr(
        importlib.util, "find_spec", lambda name, *rest: None if name == "nav2_msgs" else find(name, *rest)
    )
    robot, nav2 = Robot(Nav2(Nav2Options(patience=2.0))), Link("nav2")
    try:
        robot.controller.follow(way_to(0.5, 0.0))
        assert "nobody listens to /goal_pose" in robot.run(is_over, 5.0).reason
        commands = nav2.publisher(Twist, "cmd_vel_nav", QoSProfile(depth=1))
        goals: list[PoseStamped] = []
        nav2.subscribe(PoseStamped, "goal_pose", goals.append, QoSProfile(depth=1))
        nav2.start()
        forward = Twist()
        forward.linear.x = 0.3

        def drive(output: ControlOutput) -> bool:
            if goals and robot.pose.x < 0.45:
                commands.publish(forward)
            return is_over(output)

        robot.controller.follow(way_to(0.5, 0.0))
        assert robot.run(drive, 12.0).status is ControlStatus.ARRIVED
        assert (goals[-1].pose.position.x, goals[-1].header.frame_id) == (0.5, "map")
    finally:
        robot.driver.close()
        nav2.close()
