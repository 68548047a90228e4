"""Values of single recorded messages."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import fields
from typing import Any

from explore_bt.interfaces import Event
from explore_bt.recording import RecordedMessage
from explore_bt.types import MotionState, Pose2, Score, Twist2, Waypoint

__all__ = ["event_of", "motion_of", "number", "pose_of", "score_of", "waypoint_of"]

_LEVELS = {1: "debug", 2: "info", 3: "warning", 4: "error"}
_SCORES = tuple(field.name for field in fields(Score))


def number(value: object, otherwise: float = math.nan) -> float:
    """A number that may have been written as a word (``inf``), or left out."""
    try:
        return float(value)  # type: ignore[arg-type]  # anything may stand there
    except (TypeError, ValueError):
        return otherwise


def pose_of(value: Mapping[str, Any]) -> Pose2:
    """Of ``foxglove.PoseInFrame``; not finite where there was none."""
    pose = value["pose"]
    at, turn = pose["position"], pose["orientation"]
    return Pose2(number(at["x"]), number(at["y"]), 2.0 * math.atan2(number(turn["z"]), number(turn["w"])))


def score_of(value: Mapping[str, Any]) -> Score:
    """Of ``explore_bt.State``."""
    known = {name: value[name] for name in _SCORES if value.get(name) is not None}
    return Score(**known)


def motion_of(value: Mapping[str, Any]) -> MotionState:
    """Of ``explore_bt.State``."""
    return MotionState(Twist2(number(value.get("speed_mps"), 0.0), number(value.get("turn_rate_rps"), 0.0)))


def waypoint_of(value: Mapping[str, Any]) -> Waypoint:
    """Of ``/<robot>/visited``."""
    gain_m2 = number(value.get("expected_gain_m2"), 0.0)
    return Waypoint(pose_of(value), str(value.get("reason", "")), gain_m2)


def event_of(message: RecordedMessage, robots: tuple[str, ...]) -> Event:
    """Of ``/events``."""
    robot, slash, source = str(message.value.get("name", "")).partition("/")
    if not slash or robot not in robots:
        robot, source = "", str(message.value.get("name", ""))
    level = _LEVELS.get(int(number(message.value.get("level"), 2.0)), "info")
    return Event(message.stamp_s, robot, level, source, str(message.value.get("message", "")))
