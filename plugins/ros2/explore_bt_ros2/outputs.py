"""What others on ROS 2 are shown of a mission."""

from __future__ import annotations

import json
import math
from typing import Any, ClassVar

import numpy as np
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from geometry_msgs.msg import PoseStamped, PoseWithCovarianceStamped
from nav_msgs.msg import OccupancyGrid as GridMessage
from nav_msgs.msg import Path as PathMessage
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import String
from visualization_msgs.msg import MarkerArray

from explore_bt.interfaces import (
    API_VERSION,
    NodeInfo,
    PluginOptions,
    RobotSnapshot,
    RunInfo,
    Sink,
    TickSnapshot,
)
from explore_bt.types import Health, OccupancyGrid, Path, Pose2, Result
from explore_bt_ros2.connection import Connection
from explore_bt_ros2.feedback import feedback_of
from explore_bt_ros2.grids import grid_message
from explore_bt_ros2.marks import marks_of
from explore_bt_ros2.services import Services
from explore_bt_ros2.stamps import stamp_message
from explore_bt_ros2.transforms import Transform, encode

__all__ = ["Ros2Outputs"]

_KEPT = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
_MAP_PERIOD_S = 1.0
_SLOW_PERIOD_S = 1.0


class Ros2Outputs(Sink):
    """Map, tf map → odom, pose, path, marks, diagnostics, the tree's state, feedback and result.

    The driver brings it along; it is in no mission file. Map and tf are left to a neighbour's SLAM where
    there is one.
    """

    name = "ros2_outputs"
    api_version = API_VERSION
    Options: ClassVar[type[PluginOptions]] = PluginOptions

    def __init__(self, connection: Connection, services: Services, robot: str) -> None:
        super().__init__(PluginOptions())
        self._connection = connection
        self._services = services
        self._robot = robot
        self._nodes: tuple[NodeInfo, ...] = ()
        self._shown: dict[str, object] = {}
        self._due_s: dict[str, float] = {}
        link = connection.link
        self._tf = link.publisher(link.tf_type, connection.options.tf_topic, QoSProfile(depth=100))
        self._map = link.publisher(GridMessage, "map", _KEPT)
        self._pose = link.publisher(PoseWithCovarianceStamped, "~/pose", QoSProfile(depth=10))
        self._path = link.publisher(PathMessage, "~/path", _KEPT)
        self._marks = link.publisher(MarkerArray, "~/marks", _KEPT)
        self._tree = link.publisher(String, "~/tree", _KEPT)
        self._feedback = link.publisher(String, "~/feedback", QoSProfile(depth=10))
        self._result = link.publisher(String, "~/result", _KEPT)
        self._diagnostics = link.publisher(DiagnosticArray, "/diagnostics", QoSProfile(depth=10))

    def open(self, run: RunInfo) -> None:
        """Remember the tree."""
        self._nodes = run.trees[self._robot]

    def on_tick(self, tick: TickSnapshot) -> None:
        """Publish what has changed."""
        robot = next(each for each in tick.robots if each.robot == self._robot)
        stamp = stamp_message(self._connection.clock.stamp_s(robot.estimate.stamp_s))
        self._show_pose(robot, stamp)
        if not self._connection.has_neighbour_map.is_set():
            self._show_correction(robot)
            if self._is_news("map", robot.grid, tick.stamp_s, _MAP_PERIOD_S):
                self._show_map(robot.grid, stamp)
        if self._is_news("path", robot.path, tick.stamp_s):
            self._show_path(robot.path, stamp)
        if self._is_news("marks", robot.drawing, tick.stamp_s):
            frame = self._connection.options.map_frame
            self._marks.publish(marks_of(robot.drawing, robot.path, frame, stamp))
        if self._is_news("tree", robot.nodes, tick.stamp_s):
            self._show_tree(robot)
        if tick.stamp_s >= self._due_s.get("diagnostics", -math.inf):
            self._due_s["diagnostics"] = tick.stamp_s + _SLOW_PERIOD_S
            self._show_diagnostics(robot, stamp)
            feedback = feedback_of(self._services.state, self._nodes, robot, tick.stamp_s)
            self._feedback.publish(String(data=json.dumps(feedback)))

    def close(self, result: Result | None) -> None:
        """Publish how it ended; that and the last map stay as long as the process."""
        self._services.end()
        if result is not None:
            self._result.publish(String(data=json.dumps(result.as_dict())))

    def _is_news(self, what: str, value: object, now_s: float, period_s: float = 0.0) -> bool:
        if self._shown.get(what, self) is value or now_s < self._due_s.get(what, -math.inf):
            return False
        self._shown[what], self._due_s[what] = value, now_s + period_s
        return True

    def _headed(self, message: Any, stamp: Any) -> Any:
        message.header.stamp = stamp
        message.header.frame_id = self._connection.options.map_frame
        return message

    def _show_pose(self, robot: RobotSnapshot, stamp: Any) -> None:
        message = self._headed(PoseWithCovarianceStamped(), stamp)
        _fill(message.pose.pose, robot.estimate.T_map_base)
        covariance = np.zeros((6, 6))
        covariance[np.ix_([0, 1, 5], [0, 1, 5])] = robot.estimate.covariance
        message.pose.covariance = covariance.reshape(-1)
        self._pose.publish(message)

    def _show_correction(self, robot: RobotSnapshot) -> None:
        """T_map_odom, so that others find the robot in our map."""
        options, buffer = self._connection.options, self._connection.buffer
        ros_s = self._connection.clock.stamp_s(robot.estimate.stamp_s)
        T_odom_base = buffer.find(options.odom_frame, options.base_frame, ros_s)
        if T_odom_base is None:
            return
        T = Transform.planar(ros_s, options.map_frame, options.base_frame, robot.estimate.T_map_base)
        T_map_odom = T.matrix() @ np.linalg.inv(T_odom_base)
        found = Transform.of_matrix(ros_s, options.map_frame, options.odom_frame, T_map_odom)
        self._tf.publish(encode([found]))

    def _show_map(self, grid: OccupancyGrid, stamp: Any) -> None:
        message = self._headed(GridMessage(), stamp)
        message.info.map_load_time = stamp
        self._map.publish(grid_message(message, grid))

    def _show_path(self, path: Path | None, stamp: Any) -> None:
        message = self._headed(PathMessage(), stamp)
        poses = np.empty((0, 3)) if path is None else path.poses
        for x, y, yaw in poses.tolist():
            posed = self._headed(PoseStamped(), stamp)
            _fill(posed.pose, Pose2(x, y, yaw))
            message.poses.append(posed)
        self._path.publish(message)

    def _show_tree(self, robot: RobotSnapshot) -> None:
        states = [
            {"path": info.path, "type": info.type, "status": state.status, "message": state.message}
            for info, state in zip(self._nodes, robot.nodes, strict=True)
        ]
        self._tree.publish(String(data=json.dumps(states)))

    def _show_diagnostics(self, robot: RobotSnapshot, stamp: Any) -> None:
        estimate, score = robot.estimate, robot.score
        held = robot.gate_reason
        levels = {Health.OK: DiagnosticStatus.OK, Health.DEGRADED: DiagnosticStatus.WARN}
        level = levels.get(estimate.health, DiagnosticStatus.ERROR)
        figures = {
            "distance_m": f"{score.distance_m:.2f}",
            "speed_mps": f"{robot.motion.twist.linear_mps:.2f}",
            "charge": "" if robot.charge is None else f"{robot.charge:.2f}",
        }
        slam = DiagnosticStatus(level=level, name="explore_bt: slam", message=estimate.reason or "ok")
        gate = DiagnosticStatus(
            level=DiagnosticStatus.WARN if held else DiagnosticStatus.OK,
            name="explore_bt: safety gate",
            message=held or "free",
            values=[KeyValue(key=key, value=value) for key, value in figures.items()],
        )
        for status in (slam, gate):
            status.hardware_id = self._robot
        message = DiagnosticArray(status=[slam, gate])
        message.header.stamp = stamp
        self._diagnostics.publish(message)


def _fill(message: Any, pose: Pose2) -> None:
    message.position.x, message.position.y = pose.x, pose.y
    message.orientation.z, message.orientation.w = math.sin(0.5 * pose.yaw_rad), math.cos(0.5 * pose.yaw_rad)
