"""Stands between a robot and a mission, passes everything on, and spoils it on demand."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from typing import Any

import numpy as np
from explore_bt_ros2.link import Link
from explore_bt_ros2.stamps import seconds_of, stamp_message
from explore_bt_ros2.transforms import Transform, encode
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from sensor_msgs.msg import Imu, LaserScan
from std_msgs.msg import Bool

from explore_bt.types import Pose2

__all__ = ["Relay"]

_SENSOR = QoSProfile(depth=10, reliability=ReliabilityPolicy.BEST_EFFORT)
_KEPT = QoSProfile(depth=10, durability=DurabilityPolicy.TRANSIENT_LOCAL)

Spoil = Callable[[Any], list[Any]]


def passed(message: Any) -> list[Any]:
    """As it came."""
    return [message]


class Relay:
    """The robot is in the namespace ``real``; the mission's names are the usual ones.

    Attributes:
        scan, odom: what becomes of each message; nothing, or several.
        commands: time (``time.monotonic``), speed and turn rate of every command.
        odometry: the robot's own, newest last.
    """

    def __init__(self) -> None:
        self._link = Link("relay")
        self.scan: Spoil = passed
        self.odom: Spoil = passed
        self.commands: list[tuple[float, float, float]] = []
        self.odometry: list[tuple[float, float, float]] = []
        self._moved = threading.Condition()
        self._scans = self._link.publisher(LaserScan, "scan", _SENSOR)
        self._odoms = self._link.publisher(Odometry, "odom", _SENSOR)
        self._imus = self._link.publisher(Imu, "imu", _SENSOR)
        self._base = self._link.publisher(Twist, "real/cmd_vel", QoSProfile(depth=1))
        self._emergency = self._link.publisher(Bool, "emergency_stop", QoSProfile(depth=1))
        self._fixed = self._link.publisher(self._link.tf_type, "/tf_static", _KEPT)
        self._link.subscribe(LaserScan, "real/scan", self._on_scan, _SENSOR)
        self._link.subscribe(Odometry, "real/odom", self._on_odom, _SENSOR)
        self._link.subscribe(Imu, "real/imu", self._imus.publish, _SENSOR, raw=True)
        self._link.subscribe(Twist, "cmd_vel", self._on_command, QoSProfile(depth=10))
        self._link.start()

    def press(self, pressed: bool) -> None:
        """The emergency stop."""
        self._emergency.publish(Bool(data=pressed))

    def place_laser(self, x: float) -> None:
        """Say on tf where the lidar is."""
        self._fixed.publish(encode([Transform.planar(0.0, "base_link", "laser", Pose2(x, 0.0, 0.0))]))

    def wait_for_speed(self, at_least_mps: float, deadline_s: float) -> None:
        """Until the robot is told to drive."""
        with self._moved:
            moving = self._moved.wait_for(
                lambda: self.commands and self.commands[-1][1] >= at_least_mps, deadline_s
            )
        assert moving, f"no command of {at_least_mps} m/s for {deadline_s} s; last: {self.commands[-3:]}"

    def close(self) -> None:
        self._link.close()

    def _on_scan(self, message: Any) -> None:
        for each in self.scan(message):
            self._scans.publish(each)

    def _on_odom(self, message: Any) -> None:
        place = message.pose.pose.position
        self.odometry.append((time.monotonic(), place.x, place.y))
        for each in self.odom(message):
            self._odoms.publish(each)

    def _on_command(self, message: Any) -> None:
        self._base.publish(message)
        with self._moved:
            self.commands.append((time.monotonic(), message.linear.x, message.angular.z))
            self._moved.notify_all()


def silent(_: Any) -> list[Any]:
    return []


def later(seconds: float) -> Spoil:
    """Stamps moved by so much."""

    def spoil(message: Any) -> list[Any]:
        message.header.stamp = stamp_message(seconds_of(message.header.stamp) + seconds)
        return [message]

    return spoil


def running_back() -> Spoil:
    """Every stamp a little before the last one."""
    behind_s = [0.0]

    def spoil(message: Any) -> list[Any]:
        behind_s[0] += 0.12
        return later(-behind_s[0])(message)

    return spoil


def in_frame(frame: str) -> Spoil:
    def spoil(message: Any) -> list[Any]:
        message.header.frame_id = frame
        return [message]

    return spoil


def flood(message: Any) -> list[Any]:
    """Ten for one, each a millisecond younger, ranges trembling."""
    out = []
    begin_s = seconds_of(message.header.stamp)
    for n in range(10):
        copy = LaserScan()
        for field in message.get_fields_and_field_types():
            setattr(copy, field, getattr(message, field))
        copy.header.stamp = stamp_message(begin_s - 0.001 * (9 - n))
        copy.ranges = (np.asarray(message.ranges, dtype=np.float32) + np.float32(1e-4 * n)).tolist()
        out.append(copy)
    return out


def jumped(metres: float) -> Spoil:
    def spoil(message: Any) -> list[Any]:
        message.pose.pose.position.x += metres
        return [message]

    return spoil
