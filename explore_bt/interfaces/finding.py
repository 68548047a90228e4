"""What a look at a robot that stands still brings to light."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["Finding"]


@dataclass(frozen=True, slots=True)
class Finding:
    """One thing a robot needs or could have, and what was heard of it.

    Attributes:
        name: a topic, a transform, a clock.
        heard: type, rate, frame, delay, in words; what is missing, where it is missing.
        is_fault: whether the mission would not run like this.
        hint: the line that mends it; empty where nothing is to be mended.
    """

    name: str
    heard: str
    is_fault: bool = False
    hint: str = ""
