"""Stands between a robot and a mission, passes everything on, and spoils it on demand."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
from explore_bt_ros2.link import Link
from explore_bt_ros2.stamps import seconds_of, stamp_message
from explore_bt_ros2.transforms import Transform, decode, encode
from geometry_msgs.msg import TwistStamped
from nav_msgs.msg import Odometry
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import Imu, LaserScan
from std_msgs.msg import Bool

from explore_bt.types import Pose2

__all__ = ["Relay"]

_SENSOR = QoSProfile(depth=10, reliability=ReliabilityPolicy.BEST_EFFORT)
_PASSED_ON = QoSProfile(depth=10)
"""Reliable: those who ask for best effort hear it as well."""
_KEPT = QoSProfile(depth=10, durability=DurabilityPolicy.TRANSIENT_LOCAL)

Spoil = Callable[[Any], list[Any]]


def passed(message: Any) -> list[Any]:
    """As it came."""
    return [message]


class Relay:
    """The robot is in the namespace ``real``, tf within it; the mission's names are the usual ones.

    Args:
        passes_scans: whether it passes scans on; else a node of its own does (``scan_node.py``).

    Attributes:
        scan, odom, tf: what becomes of each message; nothing, or several. Those of tf are ``Transform``.
        commands: stamp, speed and turn rate of every command, seconds of the ROS clock.
        odometry: stamp and place of the robot's own, newest last.
    """

    def __init__(self, *, passes_scans: bool = True) -> None:
        self._link = link = Link("relay")
        self.scan: Spoil = passed
        self.odom: Spoil = passed
        self.tf: Spoil = passed
        self.commands: list[tuple[float, float, float]] = []
        self.odometry: list[tuple[float, float, float]] = []
        self._clock_s: float | None = None
        self._moved = threading.Condition()
        self._then: Callable[[], None] | None = None
        self._then_s = 0.0
        self._odoms = link.publisher(Odometry, "odom", _PASSED_ON)
        self._imus = link.publisher(Imu, "imu", _PASSED_ON)
        self._base = link.publisher(TwistStamped, "real/cmd_vel", QoSProfile(depth=1))
        self._emergency = link.publisher(Bool, "emergency_stop", QoSProfile(depth=1))
        self._moving = link.publisher(link.tf_type, "/tf", QoSProfile(depth=100))
        self._fixed = link.publisher(link.tf_type, "/tf_static", _KEPT)
        link.subscribe(Clock, "/clock", self._on_clock, _SENSOR)
        if passes_scans:
            self._scans = link.publisher(LaserScan, "scan", _PASSED_ON)
            link.subscribe(LaserScan, "real/scan", self._on_scan, _SENSOR)
        link.subscribe(Odometry, "real/odom", self._on_odom, _SENSOR)
        link.subscribe(Imu, "real/imu", self._imus.publish, _SENSOR, raw=True)
        link.subscribe(link.tf_type, "real/tf", self._on_tf, QoSProfile(depth=100), raw=True)
        link.subscribe(link.tf_type, "real/tf_static", self._fixed.publish, _KEPT, raw=True)
        link.subscribe(TwistStamped, "cmd_vel", self._on_command, QoSProfile(depth=10))
        link.start()

    def now_s(self) -> float:
        """The ROS clock, seconds: what ``/clock`` said last, or the system's."""
        return time.time() if self._clock_s is None else self._clock_s

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

    def wait_for_rest(self, since_s: float, deadline_s: float) -> bool:
        """Whether the robot is told to stand, four times in a row after ``since_s``; waits for it."""

        def rests() -> bool:
            last = self.commands[-4:]
            return all(sent_s > since_s and (v, w) == (0.0, 0.0) for sent_s, v, w in last)

        with self._moved:
            return self._moved.wait_for(rests, deadline_s)

    def right_after_a_scan(self, begin: Callable[[], None], deadline_s: float) -> float:
        """Have ``begin`` called when a scan has just been passed on, the worst moment; when that was.

        Returns:
            Seconds of the ROS clock.
        """
        with self._moved:
            self._then = begin
            assert self._moved.wait_for(lambda: self._then is None, deadline_s), "no scan comes"
        return self._then_s

    def close(self) -> None:
        self._link.close()

    def _on_clock(self, message: Any) -> None:
        self._clock_s = seconds_of(message.clock)

    def _on_scan(self, message: Any) -> None:
        for each in self.scan(message):
            self._scans.publish(each)
        with self._moved:
            if self._then is not None:
                self._then()
                self._then, self._then_s = None, self.now_s()
                self._moved.notify_all()

    def _on_odom(self, message: Any) -> None:
        place = message.pose.pose.position
        self.odometry.append((seconds_of(message.header.stamp), place.x, place.y))
        for each in self.odom(message):
            self._odoms.publish(each)

    def _on_tf(self, data: bytes) -> None:
        for each in decode(data):
            for spoilt in self.tf(each):
                self._moving.publish(encode([spoilt]))

    def _on_command(self, message: Any) -> None:
        self._base.publish(message)
        with self._moved:
            twist = message.twist
            self.commands.append((seconds_of(message.header.stamp), twist.linear.x, twist.angular.z))
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
    """Of tf: everything ahead of where it was."""

    def spoil(transform: Transform) -> list[Transform]:
        x, y, z = transform.shift
        return [replace(transform, shift=(x + metres, y, z))]

    return spoil
