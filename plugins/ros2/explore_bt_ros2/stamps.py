"""Stamps of messages."""

from __future__ import annotations

import math
from typing import Any

from builtin_interfaces.msg import Time

__all__ = ["seconds_of", "stamp_message"]


def seconds_of(stamp: Any) -> float:
    """Seconds of a ``builtin_interfaces/Time``."""
    return float(stamp.sec) + 1e-9 * float(stamp.nanosec)


def stamp_message(ros_s: float) -> Any:
    """``builtin_interfaces/Time`` of seconds."""
    second = math.floor(ros_s)
    return Time(sec=second, nanosec=min(round(1e9 * (ros_s - second)), 999_999_999))
