"""What can be heard of a robot before a wheel turns."""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
from rclpy.qos import QoSProfile

from explore_bt.interfaces import Finding
from explore_bt_ros2.connection import Connection
from explore_bt_ros2.senses import Senses, Topic
from explore_bt_ros2.stamps import seconds_of

__all__ = ["survey"]

_LEAST_TURNS, _TURNS = 1.2, 2.2
"""Of the lidar in ``silence``: with fewer the robot stops of itself; with so many one may be lost."""
_LATE_S = 0.3
_POLL_S = 0.1
_OPTIONAL = "not needed; name its topic if the robot has one"
_TF = "tf2_msgs/msg/TFMessage"
_STAMPED = "geometry_msgs/msg/TwistStamped"


def survey(connection: Connection, senses: Senses, listen_s: float) -> list[Finding]:
    """Listen for so long, then say what was heard, what is missing, and what to type.

    Args:
        connection: to the robot.
        senses: subscribed already.
        listen_s: real time.
    """
    heard: dict[str, list[tuple[Any, float]]] = {topic.name: [] for topic in senses.topics}
    refused: dict[str, str] = {}
    end_s = time.monotonic() + listen_s
    while time.monotonic() < end_s:
        time.sleep(_POLL_S)
        for topic in senses.topics:
            messages = topic.take()
            heard[topic.name] += messages
            senses.judge(topic, messages)
            if topic.refusal:
                refused[topic.name] = topic.refusal
    findings = [_topic(connection, senses, topic, heard[topic.name], refused) for topic in senses.topics]
    return [_clock(connection), *findings, *_transforms(connection), _commands(connection)]


def _clock(connection: Connection) -> Finding:
    if not connection.options.use_sim_time:
        if connection.link.node.get_publishers_info_by_topic("/clock"):
            return Finding(
                "clock",
                "the system's, though somebody publishes /clock",
                True,
                "driver: {use_sim_time: true}",
            )
        return Finding("clock", "the system's")
    words = connection.clock.fault()
    return Finding("clock", words or "/clock", bool(words), "start the simulator" if words else "")


def _topic(
    connection: Connection,
    senses: Senses,
    topic: Topic,
    messages: Sequence[tuple[Any, float]],
    refused: dict[str, str],
) -> Finding:
    speakers = connection.link.node.get_publishers_info_by_topic(topic.name)
    if not messages:
        why = senses.why_silent(topic) or "its publisher says nothing"
        return Finding(topic.name, why, topic.needed, _hint(connection, topic) if topic.needed else _OPTIONAL)
    stamps_s = [connection.clock.mission_s(seconds_of(each.header.stamp)) for each, _ in messages]
    delays_s = np.array([arrived_s for _, arrived_s in messages]) - stamps_s
    span_s = messages[-1][1] - messages[0][1]
    rate_hz = (len(messages) - 1) / span_s if span_s > 0.0 else 0.0
    words = [
        topic.kind,
        f"{rate_hz:.1f} Hz",
        f"frame {messages[-1][0].header.frame_id or 'without a name'}",
        f"{1e3 * float(np.median(delays_s)):.0f} ms old",
        *sorted({_qos(each.qos_profile) for each in speakers}),
    ]
    if len(speakers) > 1:
        words.append(f"{len(speakers)} publishers")
    faults = [refused[topic.name]] if topic.name in refused else []
    if topic.needed and rate_hz * connection.options.silence < _LEAST_TURNS:
        slow = _TURNS / max(rate_hz, 0.1)
        faults.append(f"{rate_hz:.1f} Hz is slow for driving: set silence: {slow:.2f} s and a low speed")
    if topic.needed and float(np.median(delays_s)) > _LATE_S:
        faults.append("its messages come late")
    return Finding(topic.name, ", ".join(words), bool(faults), "; ".join(faults))


def _transforms(connection: Connection) -> Iterator[Finding]:
    options, buffer = connection.options, connection.buffer
    name = f"tf {options.odom_frame} → {options.base_frame}"
    stamp_s = buffer.newest_s(options.odom_frame, options.base_frame)
    if stamp_s is None:
        needed = not options.odom_topic
        frames = ", ".join(buffer.frames()) or "none"
        other = _other_tf(connection)
        named = f"driver: {{tf_topic: {other}}}" if other else "name odom_topic"
        hint = named if needed or other else _OPTIONAL
        yield Finding(name, f"missing; frames on {options.tf_topic}: {frames}", needed, hint)
    else:
        age_s = connection.clock.now_s() - connection.clock.mission_s(stamp_s)
        yield Finding(name, f"{1e3 * max(age_s, 0.0):.0f} ms old" if np.isfinite(stamp_s) else "fixed")


def _other_tf(connection: Connection) -> str:
    """Another topic on which somebody tells transforms that move; empty if there is none."""
    ours = connection.link.full_name(connection.options.tf_topic)
    node = connection.link.node
    names = [name for name, kinds in node.get_topic_names_and_types() if _TF in kinds]
    others = [name for name in names if name != ours and not name.endswith("_static")]
    return next((name for name in others if node.count_publishers(name)), "")


def _commands(connection: Connection) -> Finding:
    """Who drives, if somebody listens."""
    options = connection.options
    name = connection.link.full_name(options.command_topic)
    listeners = connection.link.node.get_subscriptions_info_by_topic(name)
    wanted = _STAMPED if options.stamped else "geometry_msgs/msg/Twist"
    if not listeners:
        return Finding(name, "nobody listens", True, "start the robot's base, or name its command_topic")
    kinds = {each.topic_type for each in listeners}
    if wanted not in kinds:
        other = "false" if options.stamped else "true"
        return Finding(
            name, f"the base listens to {', '.join(sorted(kinds))}", True, f"driver: {{stamped: {other}}}"
        )
    speakers = connection.link.node.get_publishers_info_by_topic(name)
    if len(speakers) > 1:
        rivals = ", ".join(sorted(each.node_name for each in speakers if each.node_name != "explore_bt"))
        return Finding(
            name, f"somebody else commands the robot too: {rivals}", True, "stop it, or use a twist_mux"
        )
    return Finding(name, f"{wanted}, {len(listeners)} listening")


def _hint(connection: Connection, topic: Topic) -> str:
    """Topics of the same type that do speak."""
    others = [
        name
        for name, kinds in connection.link.node.get_topic_names_and_types()
        if topic.kind in kinds and name != topic.name
    ]
    option = "scan_topic" if topic.kind.endswith("LaserScan") else "cloud_topic"
    if others:
        return f"driver: {{{option}: {others[0]}}}"
    return (
        "start its node; is ROS_DOMAIN_ID the robot's, and discovery wide enough "
        "(driver: {discovery: subnet})"
    )


def _qos(profile: QoSProfile) -> str:
    return f"{profile.reliability.name.lower()} {profile.durability.name.lower()}"
