"""All that a robot's topics tell."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
from nav_msgs.msg import Odometry
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from sensor_msgs.msg import BatteryState, CameraInfo, Image, Imu, LaserScan, PointCloud2
from std_msgs.msg import Bool

from explore_bt.ros_messages import MESSAGES, CameraStream, CameraTopics, planar
from explore_bt.types import Battery, Measurement, Pose2, WheelOdometry
from explore_bt_ros2.clock import RosClock
from explore_bt_ros2.link import Link
from explore_bt_ros2.options import Ros2Options
from explore_bt_ros2.senses.odometry import SmoothOdometry
from explore_bt_ros2.senses.order import Order
from explore_bt_ros2.senses.places import Places
from explore_bt_ros2.senses.topic import Topic
from explore_bt_ros2.transforms import TransformBuffer, decode

__all__ = ["Senses"]

_AHEAD_S = 0.1
"""A stamp may be ahead of the clock by the jitter of two computers that are in step."""
_OLD_S = 0.5
_DOUBT_S = 2.0
"""For so long a robot stands after its odometry was set anew."""
_DEPTH = 50
_POLL_S = 0.02

_CLOUD = MESSAGES["sensor_msgs/msg/PointCloud2"]

Decode = Callable[[Any], Measurement | None]


class Senses:
    """Subscribes, decodes, checks stamps; what is wrong with a topic is told in words.

    Args:
        link: to the robot.
        options: names and frames.
        clock: mission time.
        buffer: filled with what tf says.
    """

    def __init__(self, link: Link, options: Ros2Options, clock: RosClock, buffer: TransformBuffer) -> None:
        self._link = link
        self._options = options
        self._clock = clock
        self._buffer = buffer
        self._places = Places(buffer, options.base_frame, (options.odom_frame, options.map_frame))
        self._order: Order[Any] = Order()
        self._newest_s: dict[str, float] = {}
        self._smooth = SmoothOdometry(options.limits)
        self._pressed = False
        self._tf_stamp_s = 0.0
        self.topics: list[Topic] = []
        self._decoders: dict[str, Decode] = {}
        self._odometry = Topic(f"tf {options.odom_frame} → {options.base_frame}", "tf", needed=False)
        self._listen()

    def wait_for_lidar(self, timeout_s: float) -> bool:
        """Whether a lidar has spoken; waits for it."""
        end_s = time.monotonic() + timeout_s
        while not any(topic.is_heard for topic in self.topics if topic.needed):
            if time.monotonic() > end_s:
                return False
            time.sleep(_POLL_S)
        return True

    def read(self) -> list[Measurement]:
        """Everything good that has come since the last call, in the order in which it was measured."""
        now_s = self._clock.now_s()
        fresh: list[tuple[Measurement, float]] = []
        for topic in self.topics:
            fresh += self.judge(topic, topic.take())
        if not self._options.odom_topic:
            fresh += self._odometry_of_tf(now_s)
        return self._order.sort(fresh, now_s)

    def fault(self) -> str:
        """Why the robot must not drive now; empty if it may."""
        if self._pressed:
            return f"the emergency stop is pressed ({self._options.emergency_topic})"
        if words := self._clock.fault():
            return words
        now_s, silence_s = self._clock.now_s(), self._options.silence
        for topic in (*self.topics, self._odometry):
            if topic.kind == "sensor_msgs/msg/BatteryState" or topic.name in self._quiet:
                continue
            if words := topic.fault(now_s, silence_s, ""):
                return topic.fault(now_s, silence_s, self.why_silent(topic)) or words
        return ""

    def why_silent(self, topic: Topic) -> str:
        """What is known about a topic that says nothing, in words."""
        if words := self._link.mismatches.get(topic.name):
            return f"{words}; set the option reliability"
        if topic.kind == "tf":
            return ""
        speakers = self._link.node.get_publishers_info_by_topic(topic.name)
        if not speakers:
            return "nobody publishes it"
        if others := {each.topic_type for each in speakers} - {topic.kind}:
            return f"it is of type {', '.join(sorted(others))}; expected {topic.kind}"
        return ""

    def _listen(self) -> None:
        options = self._options
        lidars = [name for name in (options.scan_topic, options.cloud_topic) if name]
        for name, message, newest in (
            (options.scan_topic, LaserScan, 20),
            (options.cloud_topic, PointCloud2, 5),
            (options.imu_topic, Imu, 500),
            (options.odom_topic, Odometry, 200),
        ):
            kind = _kind(message)
            self._hear(name, message, partial(self._measure, MESSAGES[kind]), name in lidars, newest)
        self._hear(options.battery_topic, BatteryState, self._battery, needed=False)
        self._hear_camera()
        if options.emergency_topic:
            self._link.subscribe(Bool, options.emergency_topic, self._press, _qos("best_effort", 1))
        tf = self._link.tf_type
        moving, fixed = (
            QoSProfile(depth=100),
            QoSProfile(depth=100, durability=DurabilityPolicy.TRANSIENT_LOCAL),
        )
        learn, learn_fixed = self._buffer.learn, self._buffer.learn_fixed
        self._link.subscribe(tf, options.tf_topic, lambda data: learn(decode(data)), moving, raw=True)
        self._link.subscribe(
            tf, f"{options.tf_topic}_static", lambda data: learn_fixed(decode(data)), fixed, raw=True
        )

    def _hear_camera(self) -> None:
        options = self._options
        self._quiet: set[str] = set()
        if not (options.colour_topic and options.depth_topic):
            return
        names = [self._link.full_name(each) for each in (options.colour_topic, options.depth_topic)]
        info = f"{names[0].rpartition('/')[0]}/camera_info"
        self._camera = _Camera(CameraTopics(names[0], names[1], info, ""), self._places)
        for name, message in ((names[0], Image), (names[1], Image), (info, CameraInfo)):
            self._hear(name, message, partial(self._camera.take, name), needed=False, newest=5)
            self._quiet.add(name)

    def _hear(self, name: str, message: Any, decode_it: Decode, needed: bool, newest: int = 50) -> None:
        if not name:
            return
        topic = Topic(self._link.full_name(name), _kind(message), needed, newest)
        self.topics.append(topic)
        self._decoders[topic.name] = decode_it
        clock = self._clock
        self._link.subscribe(
            message,
            topic.name,
            lambda data: topic.put(data, clock.now_s()),
            _qos(self._options.reliability, _DEPTH),
        )

    def _press(self, message: Any) -> None:
        self._pressed = bool(message.data)

    def judge(self, topic: Topic, messages: Sequence[tuple[Any, float]]) -> list[tuple[Measurement, float]]:
        """The good ones among a topic's messages, decoded; the topic remembers what was wrong with others."""
        good = []
        for message, arrived_s in messages:
            try:
                with np.errstate(all="ignore"):  # what overflows in a damaged message is infinite afterwards
                    measured = self._decoders[topic.name](message)
                if measured is None:
                    topic.accept(arrived_s)
                    continue
                measured = self._timed(topic, measured, arrived_s)
            except ValueError as fault:
                topic.refuse(str(fault))
                continue
            topic.accept(arrived_s)
            self._link.mismatches.pop(topic.name, None)  # somebody whom we hear is there as well
            if isinstance(measured, WheelOdometry):
                measured, jump = self._smooth.take(measured)
                if jump:
                    topic.suspect(jump, arrived_s + _DOUBT_S)
            good.append((measured, arrived_s))
        return good

    def _timed(self, topic: Topic, measured: Measurement, arrived_s: float) -> Measurement:
        """The same on the mission's clock.

        Raises:
            ValueError: a stamp that cannot be.
        """
        stamp_s = self._clock.mission_s(measured.stamp_s)
        if stamp_s > arrived_s + _AHEAD_S:
            raise ValueError(
                f"its stamp is {stamp_s - arrived_s:.2f} s in the future; are the clocks in step (chrony), "
                "or is use_sim_time wrong"
            )
        if stamp_s < arrived_s - _OLD_S:
            raise ValueError(
                f"its stamp is {arrived_s - stamp_s:.2f} s old; are the clocks in step (chrony), "
                "or is use_sim_time wrong"
            )
        newest_s = self._newest_s.get(topic.name, -1.0)
        if stamp_s < newest_s:
            raise ValueError(f"its stamp has gone back by {newest_s - stamp_s:.3f} s")
        self._newest_s[topic.name] = stamp_s
        return replace(measured, stamp_s=min(stamp_s, arrived_s))

    def _measure(self, of: Callable[..., Measurement], message: Any) -> Measurement:
        return of(message, self._places, self._options.cloud_range if of is _CLOUD else None)

    def _battery(self, message: Any) -> Measurement | None:
        charge = float(message.percentage)
        stamp = message.header.stamp
        stamp_s = stamp.sec + 1e-9 * stamp.nanosec or self._clock.ros_s()
        if not 0.0 <= charge <= 100.0:
            return None  # NaN: not measured
        return Battery(stamp_s, charge if charge <= 1.0 else 0.01 * charge)

    def _odometry_of_tf(self, now_s: float) -> Sequence[tuple[Measurement, float]]:
        options = self._options
        stamp_s = self._buffer.newest_s(options.odom_frame, options.base_frame)
        if stamp_s is None or not self._tf_stamp_s < stamp_s < np.inf:
            return ()
        T = self._buffer.find(options.odom_frame, options.base_frame, stamp_s)
        if T is None:
            return ()
        self._tf_stamp_s = stamp_s
        measured = WheelOdometry(stamp_s, Pose2(float(T[0, 3]), float(T[1, 3]), planar(T[:3, :3])))
        self._decoders[self._odometry.name] = lambda found: found
        return self.judge(self._odometry, [(measured, now_s)])


class _Camera:
    """Makes RGB-D frames; the camera's frame is learnt from its first image."""

    def __init__(self, topics: CameraTopics, places: Places) -> None:
        self._topics = topics
        self._places = places
        self._stream: CameraStream | None = None

    def take(self, topic: str, message: Any) -> Measurement | None:
        """One of the three topics has spoken; a frame if it completes one."""
        if self._stream is None:
            if topic == self._topics.info:
                return None
            self._places.of(message.header.frame_id)
            topics = replace(self._topics, frame=message.header.frame_id)
            self._stream = CameraStream(topics, self._places, [])
        return self._stream.take(topic, message)


def _kind(message: Any) -> str:
    package, middle, _ = message.__module__.split(".")
    return f"{package}/{middle}/{message.__name__}"


def _qos(reliability: str, depth: int) -> QoSProfile:
    reliable = reliability == "reliable"
    return QoSProfile(
        depth=depth, reliability=ReliabilityPolicy.RELIABLE if reliable else ReliabilityPolicy.BEST_EFFORT
    )
