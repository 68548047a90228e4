"""Why the safety gate does not let a wish pass."""

from __future__ import annotations

import enum

__all__ = ["HeldBy"]


class HeldBy(enum.StrEnum):
    """What keeps the safety gate from passing the controller's commands on."""

    NOTHING = "nothing"
    OBSTACLE = "an obstacle"
    SOMEONE = "someone who moves"
    MATE = "a team mate"
    SENSES = "senses that fail"
    BODY = "a body that cannot drive"
    DEBUGGER = "the debugger"
