"""Commands on their way to the wheels, and zeros when none come."""

from __future__ import annotations

import threading
import time
from contextlib import suppress
from typing import Any

from geometry_msgs.msg import Twist, TwistStamped
from rclpy.clock import Clock as NodeClock
from rclpy.clock import ClockType
from rclpy.duration import Duration
from rclpy.qos import QoSProfile

from explore_bt.types import MotionLimits, Twist2
from explore_bt_ros2.clock import RosClock
from explore_bt_ros2.link import Link
from explore_bt_ros2.options import Ros2Options
from explore_bt_ros2.stamps import stamp_message

__all__ = ["COMMAND_LIFE_S", "Commander"]

_LATE_S = 0.2
"""Four control periods: what was commanded before is not to be driven any more."""
_CHECK_S = 0.02
COMMAND_LIFE_S = _LATE_S + _CHECK_S
"""Longer no command drives on."""
_LAST_WORDS_S = 0.3


class Commander:
    """Publishes commands, as they come; a zero when none has come for 0.2 s, and at the end.

    Args:
        link: to the robot.
        options: the topic and its type.
        clock: mission time.
    """

    def __init__(self, link: Link, options: Ros2Options, clock: RosClock) -> None:
        self._clock = clock
        self._limits = options.limits
        self._stamped = options.stamped
        self._frame = options.base_frame
        self._lock = threading.Lock()
        self._moving_since: tuple[float, float] | None = None
        self._closed = False
        self._publisher = link.publisher(
            TwistStamped if options.stamped else Twist, options.command_topic, QoSProfile(depth=1)
        )
        steady = NodeClock(clock_type=ClockType.STEADY_TIME)
        link.node.create_timer(_CHECK_S, self._check, clock=steady)

    def send(self, twist: Twist2) -> None:
        """Publish a command, within the body's limits."""
        with self._lock:
            if self._closed:
                return
            self._publish(_within(self._limits, twist))
            is_zero = twist.linear_mps == 0.0 == twist.angular_rps
            self._moving_since = None if is_zero else (self._clock.now_s(), time.monotonic())

    def stop(self) -> None:
        """Publish a zero; never raises."""
        with suppress(Exception), self._lock:
            self._halt()

    def close(self) -> None:
        """The last word on the topic is a zero; waits until it has been heard."""
        with suppress(Exception), self._lock:
            if not self._closed:
                self._halt()
                self._closed = True
                self._publisher.wait_for_all_acked(Duration(seconds=_LAST_WORDS_S))

    def _check(self) -> None:
        with self._lock:
            if self._moving_since is None or self._closed:
                return
            if self._clock.since_s(*self._moving_since) > _LATE_S:
                self._halt()

    def _halt(self) -> None:
        self._publish(Twist2())
        self._moving_since = None

    def _publish(self, twist: Twist2) -> None:
        message: Any = TwistStamped() if self._stamped else Twist()
        inner = message.twist if self._stamped else message
        inner.linear.x, inner.angular.z = twist.linear_mps, twist.angular_rps
        if self._stamped:
            message.header.stamp = stamp_message(self._clock.ros_s())
            message.header.frame_id = self._frame
        self._publisher.publish(message)


def _within(limits: MotionLimits, twist: Twist2) -> Twist2:
    return Twist2(
        min(max(twist.linear_mps, -limits.speed_mps), limits.speed_mps),
        min(max(twist.angular_rps, -limits.turn_rate_rps), limits.turn_rate_rps),
    )
