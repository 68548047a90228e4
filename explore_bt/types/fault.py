"""What is wrong with a robot's body."""

from __future__ import annotations

import enum
from dataclasses import dataclass

__all__ = ["BodyFault", "BodyFaultKind"]


class BodyFaultKind(enum.StrEnum):
    """Why a body cannot drive."""

    FALLEN = "fallen"
    """It lies on the floor."""
    RECOVERING = "recovering"
    """It is being helped, or helps itself; that passes."""
    STOPPED = "stopped"
    """Someone pressed its own emergency stop, or its motors are off."""


@dataclass(frozen=True, slots=True)
class BodyFault:
    """A body that cannot drive now, and why, in words."""

    kind: BodyFaultKind
    reason: str
