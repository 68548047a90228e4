"""Controller ``nav2``: Nav2 drives, the safety gate watches."""

from __future__ import annotations

import importlib.util
import math
import time
from typing import Any, ClassVar

from geometry_msgs.msg import PoseStamped, Twist, TwistStamped
from pydantic import Field
from rclpy.qos import QoSProfile

from explore_bt.errors import PluginError
from explore_bt.interfaces import (
    API_VERSION,
    Controller,
    ControlOutput,
    ControlStatus,
    PluginOptions,
    RobotContext,
)
from explore_bt.types import Estimate, MotionLimits, MotionState, Path, Pose2, Scan2D, Twist2
from explore_bt.units import Angle, Duration, Length
from explore_bt_ros2.connection import Connection
from explore_bt_ros2.nav2_goal import ActionGoal, Goal, GoalState, TopicGoal
from explore_bt_ros2.stamps import stamp_message

__all__ = ["Nav2", "Nav2Options"]

_FRESH_S = 0.3
"""A command of Nav2 older than this is not driven any more."""
_REST = 1e-3


class Nav2Options(PluginOptions):
    """Where Nav2 is, and how patient we are with it."""

    action: str = Field("navigate_to_pose", description="NavigateToPose, where nav2_msgs is installed")
    goal_topic: str = Field("goal_pose", description="PoseStamped, where it is not")
    command_topic: str = Field("cmd_vel_nav", description="where Nav2 sends its commands, to be watched over")
    stamped: bool = Field(False, description="those are TwistStamped")
    behavior_tree: str = Field("", description="of Nav2, for our goals; empty: its default")
    patience: Duration = Field(5.0, gt=0, description="without server or command for so long: stuck")
    arrived: Length = Field(0.25, gt=0, description="so near to the goal is there, where only a topic is")
    arrived_angle: Angle = Field(0.35, gt=0, description="turned so far at most")


class Nav2(Controller):
    """Goals go to Nav2; its commands come back, pass the safety gate, and go to the wheels.

    Nav2 plans a way of its own to the end of the path. Its commands must not reach the base by themselves:
    remap its ``cmd_vel`` to ``cmd_vel_nav``.
    """

    name = "nav2"
    api_version = API_VERSION
    Options: ClassVar[type[PluginOptions]] = Nav2Options

    def __init__(self, options: PluginOptions) -> None:
        super().__init__(options)
        self._settings = Nav2Options.model_validate(options.model_dump())
        self._limits = MotionLimits()
        self._goal: Goal | None = None
        self._target: Pose2 | None = None
        self._command: tuple[float, Twist2] = (-math.inf, Twist2())
        self._quiet_since_s: float | None = None

    def setup(self, context: RobotContext) -> None:
        """Find Nav2, through the driver's node.

        Raises:
            PluginError: the driver is not ``ros2``.
        """
        if not isinstance(context.connection, Connection):
            raise PluginError("controller nav2 needs driver ros2: write driver: {use: ros2}")
        self._limits = context.limits
        self._connection, settings = context.connection, self._settings
        link = context.connection.link
        kind: Any = TwistStamped if settings.stamped else Twist
        link.subscribe(kind, settings.command_topic, self._hear, QoSProfile(depth=1))
        if importlib.util.find_spec("nav2_msgs") is not None:
            self._goal = ActionGoal(link, settings.action, settings.behavior_tree)
        else:
            self._goal = TopicGoal(link, settings.goal_topic)

    def follow(self, path: Path) -> None:
        """Send the path's end to Nav2; a goal before it is replaced."""
        self._target, self._quiet_since_s = path.goal, None
        self._send()

    def hold(self) -> None:
        """Cancel the goal, come to rest."""
        self._target = None
        if self._goal is not None:
            self._goal.cancel()

    def step(
        self,
        estimate: Estimate,
        scan: Scan2D | None,  # noqa: ARG002  # Nav2 has its own
        motion: MotionState,
        dt_s: float,
    ) -> ControlOutput:
        """Nav2's newest command, within our limits; a brake where there is none."""
        if self._target is None or self._goal is None:
            output = self._towards(Twist2(), motion, dt_s)
            rests = abs(output.linear_mps) < _REST and abs(output.angular_rps) < _REST
            return ControlOutput(output, ControlStatus.IDLE if rests else ControlStatus.RUNNING)
        status, reason = self._progress(self._goal, self._target, estimate)
        wanted = self._wanted() if status is ControlStatus.RUNNING else Twist2()
        return ControlOutput(self._towards(wanted, motion, dt_s), status, reason)

    def _progress(self, goal: Goal, target: Pose2, estimate: Estimate) -> tuple[ControlStatus, str]:
        state, words = goal.state()
        if state is GoalState.DONE:
            return ControlStatus.ARRIVED, ""
        if state is GoalState.FAILED:
            return ControlStatus.STUCK, words
        if state is GoalState.AWAY or not goal.is_taken:
            goal.insist()
            return self._patient(words)
        if goal.knows_arrival or not self._is_quiet:
            self._quiet_since_s = None
            return ControlStatus.RUNNING, words
        off = estimate.T_map_base.between(target)
        near = math.hypot(off.x, off.y) <= self._settings.arrived
        if near and abs(off.yaw_rad) <= self._settings.arrived_angle:
            return ControlStatus.ARRIVED, ""
        return self._patient(f"Nav2 sends no commands on {self._settings.command_topic}")

    def _patient(self, words: str) -> tuple[ControlStatus, str]:
        now_s = time.monotonic()
        if self._quiet_since_s is None:
            self._quiet_since_s = now_s
        waited_s = now_s - self._quiet_since_s
        if waited_s > self._settings.patience:
            return ControlStatus.STUCK, f"{words}, for {waited_s:.0f} s"
        return ControlStatus.RUNNING, words

    def _send(self) -> None:
        if self._target is None or self._goal is None:
            return
        target, message = self._target, PoseStamped()
        message.header.frame_id = self._connection.options.map_frame
        message.header.stamp = stamp_message(self._connection.clock.ros_s())
        message.pose.position.x, message.pose.position.y = target.x, target.y
        half = 0.5 * target.yaw_rad
        message.pose.orientation.z, message.pose.orientation.w = math.sin(half), math.cos(half)
        self._goal.send(message)

    def _hear(self, message: Any) -> None:
        twist = message.twist if self._settings.stamped else message
        self._command = (time.monotonic(), Twist2(float(twist.linear.x), float(twist.angular.z)))

    @property
    def _is_quiet(self) -> bool:
        return time.monotonic() - self._command[0] > _FRESH_S

    def _wanted(self) -> Twist2:
        return Twist2() if self._is_quiet else self._command[1]

    def _towards(self, wanted: Twist2, motion: MotionState, dt_s: float) -> Twist2:
        limits = self._limits
        v = min(max(wanted.linear_mps, -limits.speed_mps), limits.speed_mps)
        w = min(max(wanted.angular_rps, -limits.turn_rate_rps), limits.turn_rate_rps)
        return Twist2(
            _approached(
                v,
                motion.twist.linear_mps,
                motion.linear_acceleration_mps2,
                limits.acceleration_mps2,
                limits.jerk_mps3,
                dt_s,
            ),
            _approached(
                w,
                motion.twist.angular_rps,
                motion.angular_acceleration_rps2,
                limits.turn_acceleration_rps2,
                limits.turn_jerk_rps3,
                dt_s,
            ),
        )


def _approached(wanted: float, now: float, change: float, most: float, jerk: float, dt_s: float) -> float:
    """The velocity a period later: as near to ``wanted`` as acceleration and jerk allow."""
    off = wanted - now
    steep = min(most, math.sqrt(2.0 * jerk * abs(off)), abs(off) / dt_s)
    following = math.copysign(steep, off)
    return now + dt_s * min(max(following, change - jerk * dt_s), change + jerk * dt_s)
