"""A stand-in for Nav2: ``main`` serves NavigateToPose, drives straight to the goal over cmd_vel_nav.

A goal with y above 50 m is aborted, one with x above 50 m rejected.
"""

from __future__ import annotations

import math
import threading
from typing import Any

import rclpy
from action_msgs.msg import GoalStatus
from geometry_msgs.msg import Twist
from nav2_msgs.action import NavigateToPose
from nav_msgs.msg import Odometry
from rclpy.action import ActionServer, CancelResponse, GoalResponse
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.qos import qos_profile_sensor_data

from explore_bt.types import Pose2, wrap_angle

_FAR_M = 50.0


class StandIn:
    """Takes odom for map: the robots it serves begin at the origin."""

    def __init__(self, node: Any) -> None:
        self._pose = Pose2.identity()
        self._newest: Any = None
        self._tick = threading.Event()
        self._commands = node.create_publisher(Twist, "cmd_vel_nav", 1)
        node.create_subscription(Odometry, "odom", self._on_odom, qos_profile_sensor_data)
        self._server = ActionServer(
            node,
            NavigateToPose,
            "navigate_to_pose",
            self._drive,
            goal_callback=self._judge,
            cancel_callback=lambda _: CancelResponse.ACCEPT,
        )

    def _judge(self, request: Any) -> Any:
        far = request.pose.pose.position.x > _FAR_M
        return GoalResponse.REJECT if far else GoalResponse.ACCEPT

    def _on_odom(self, message: Any) -> None:
        place, turn = message.pose.pose.position, message.pose.pose.orientation
        self._pose = Pose2(place.x, place.y, 2.0 * math.atan2(turn.z, turn.w))
        self._tick.set()

    def _drive(self, handle: Any) -> Any:
        self._newest = handle
        result = NavigateToPose.Result()
        if handle.request.pose.pose.position.y > _FAR_M:
            result.error_code = 9003
            handle.abort()
            return result
        while handle.status == GoalStatus.STATUS_EXECUTING and self._newest is handle:
            self._tick.wait(1.0)
            self._tick.clear()
            to_go_m, twist = self._towards(handle.request.pose.pose)
            handle.publish_feedback(NavigateToPose.Feedback(distance_remaining=to_go_m))
            if twist is None:
                self._commands.publish(Twist())
                handle.succeed()
                return result
            self._commands.publish(twist)
        self._commands.publish(Twist())
        if handle.is_cancel_requested:
            handle.canceled()
        else:
            handle.abort()
        return result

    def _towards(self, goal: Any) -> tuple[float, Any]:
        here = self._pose
        dx, dy = goal.position.x - here.x, goal.position.y - here.y
        to_go_m = math.hypot(dx, dy)
        if to_go_m < 0.1:
            return to_go_m, None
        off = wrap_angle(math.atan2(dy, dx) - here.yaw_rad)
        twist = Twist()
        twist.angular.z = max(-0.8, min(0.8, 1.5 * off))
        twist.linear.x = 0.3 if abs(off) < 0.5 else 0.0
        return to_go_m, twist


def main() -> None:
    """Until it is killed."""
    rclpy.init()
    node = rclpy.create_node("stand_in_nav2")
    server = StandIn(node)
    executor = MultiThreadedExecutor(4)
    executor.add_node(node)
    print("stand-in of Nav2 runs", flush=True)  # noqa: T201  # what the test waits for
    try:
        executor.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        del server
