"""The topics of a simulated robot."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Any

from geometry_msgs.msg import Twist, TwistStamped
from nav_msgs.msg import Odometry
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import BatteryState, CameraInfo, Image, Imu, LaserScan, PointCloud2

from explore_bt.types import Battery, Measurement, PointCloud, RgbdFrame, Scan2D, Twist2, WheelOdometry
from explore_bt.types import Imu as ImuSample
from explore_bt_ros2.link import Link
from explore_bt_ros2.stamps import stamp_message
from explore_bt_ros2.transforms import Transform, encode
from explore_bt_ros2.trial.encode import battery, camera, cloud, imu, odometry, place_of, scan

__all__ = ["TrialRobot"]

_SENSOR = QoSProfile(depth=10, reliability=ReliabilityPolicy.BEST_EFFORT)
_KEPT = QoSProfile(depth=10, durability=DurabilityPolicy.TRANSIENT_LOCAL)
_BASE, _ODOM = "base_link", "odom"


class TrialRobot:
    """Publishes what a driver measures, hears commands; QoS as real robots have it.

    Args:
        link: to the others.
        ros_s: from the driver's time to the ROS time of stamps.
        tf_topic: of what moves; what stays is on the same name with ``_static``.
        stamped: commands are ``TwistStamped``.
    """

    def __init__(
        self, link: Link, ros_s: Callable[[float], float], tf_topic: str = "/tf", *, stamped: bool = False
    ) -> None:
        self._link = link
        self._tf_topic = tf_topic
        self._ros_s = ros_s
        self._publishers: dict[str, Any] = {}
        self._places: dict[str, Transform] = {}
        self._lock = threading.Lock()
        self._command: Twist2 | None = None
        kind: Any = TwistStamped if stamped else Twist
        link.subscribe(kind, "cmd_vel", self._hear, QoSProfile(depth=1))

    def command(self) -> Twist2 | None:
        """The newest command, once."""
        with self._lock:
            command, self._command = self._command, None
        return command

    def tick(self, ros_s: float) -> None:
        """Say what time it is."""
        self._publish("/clock", Clock, Clock(clock=stamp_message(ros_s)), QoSProfile(depth=10))

    def publish(self, measured: Measurement) -> None:
        """Put a measurement on its topic, and its place on tf."""
        self._publish_place(measured)
        if isinstance(measured, Scan2D):
            self._publish("scan", LaserScan, scan(measured, self._ros_s))
        elif isinstance(measured, PointCloud):
            self._publish("points", PointCloud2, cloud(measured, self._ros_s))
        elif isinstance(measured, ImuSample):
            self._publish("imu", Imu, imu(measured, self._ros_s))
        elif isinstance(measured, WheelOdometry):
            self._publish("odom", Odometry, odometry(measured, self._ros_s, _BASE))
            stamp_s = self._ros_s(measured.stamp_s)
            moved = Transform.planar(stamp_s, _ODOM, _BASE, measured.T_odom_base)
            self._publish(self._tf_topic, self._link.tf_type, encode([moved]), QoSProfile(depth=100))
        elif isinstance(measured, Battery):
            self._publish("battery_state", BatteryState, battery(measured, self._ros_s))
        elif isinstance(measured, RgbdFrame):
            view, depth, info = camera(measured, self._ros_s)
            self._publish("camera/color/camera_info", CameraInfo, info)
            self._publish("camera/color/image_raw", Image, view)
            self._publish("camera/depth/image_raw", Image, depth)

    def _publish_place(self, measured: Measurement) -> None:
        T = place_of(measured)
        if T is None or measured.frame in self._places or measured.frame == _BASE:
            return
        self._places[measured.frame] = Transform.of_matrix(0.0, _BASE, measured.frame, T)
        fixed = encode(self._places.values())
        self._publish(f"{self._tf_topic}_static", self._link.tf_type, fixed, _KEPT)

    def _publish(self, topic: str, kind: Any, message: Any, qos: QoSProfile = _SENSOR) -> None:
        if topic not in self._publishers:
            self._publishers[topic] = self._link.publisher(kind, topic, qos)
        self._publishers[topic].publish(message)

    def _hear(self, message: Any) -> None:
        twist = message.twist if isinstance(message, TwistStamped) else message
        with self._lock:
            self._command = Twist2(float(twist.linear.x), float(twist.angular.z))
