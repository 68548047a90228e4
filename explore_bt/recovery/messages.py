"""Values of single recorded messages."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import fields
from typing import Any

from explore_bt.recording import decode_pose
from explore_bt.types import MotionState, Score, Twist2, Waypoint

__all__ = ["motion_of", "number", "score_of", "waypoint_of"]

_SCORES = tuple(field.name for field in fields(Score))


def number(value: object, otherwise: float = math.nan) -> float:
    """A number that may have been written as a word (``inf``), or left out."""
    try:
        return float(value)  # type: ignore[arg-type]  # anything may stand there
    except (TypeError, ValueError):
        return otherwise


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
    return Waypoint(decode_pose(value["pose"]), str(value.get("reason", "")), gain_m2)
