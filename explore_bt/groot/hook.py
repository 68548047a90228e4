"""A hook: a breakpoint, or an answer in a node's place, as Groot2 writes it."""

from __future__ import annotations

import enum
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from explore_bt.groot.protocol import GrootError

__all__ = ["ANSWERS", "Hook", "Mode", "Position", "number"]

ANSWERS: Mapping[str, str] = {"SUCCESS": "success", "FAILURE": "failure", "SKIPPED": ""}
"""What a client may want a node to answer -> our word; skipped means that the node is ticked itself."""


class Position(enum.IntEnum):
    """Before a node's tick, or after."""

    PRE = 0
    POST = 1


class Mode(enum.IntEnum):
    """Stop there, or answer in the node's place without stopping."""

    BREAKPOINT = 0
    REPLACE = 1


@dataclass(frozen=True, slots=True)
class Hook:
    """One hook.

    Attributes:
        uid: the node's number.
        answer: ``success``, ``failure``, or empty to let the node be ticked.
        once: gone after it was used.
    """

    uid: int
    position: Position
    mode: Mode
    enabled: bool
    once: bool
    answer: str

    @classmethod
    def parse(cls, data: Any) -> Hook:
        """From a client's JSON.

        Raises:
            GrootError: it is no hook, or one that cannot be done.
        """
        if not isinstance(data, dict):
            raise GrootError("a hook is a JSON object")
        answer = ANSWERS.get(str(data.get("desired_status", "SKIPPED")).upper())
        if answer is None:
            raise GrootError(f"desired_status is one of {', '.join(ANSWERS)}")
        hook = cls(
            uid=number(data, "uid"),
            position=Position(number(data, "position", most=1)),
            mode=Mode(number(data, "mode", most=1)),
            enabled=data.get("enabled") is not False,
            once=data.get("once") is True,
            answer=answer,
        )
        if hook.position is Position.POST and hook.mode is Mode.REPLACE:
            raise GrootError("a node that was ticked has answered itself; put the hook before it")
        return hook

    def as_json(self) -> dict[str, object]:
        """As BehaviorTree.CPP writes it."""
        words = {ours: theirs for theirs, ours in ANSWERS.items()}
        return {
            "enabled": self.enabled,
            "uid": self.uid,
            "mode": int(self.mode),
            "once": self.once,
            "desired_status": words[self.answer],
            "position": int(self.position),
        }


def number(data: Mapping[str, Any], key: str, most: int = 2**16 - 1) -> int:
    """A number of a request.

    Raises:
        GrootError: it is missing, none, or out of bounds.
    """
    value = data.get(key)
    if isinstance(value, bool) or not isinstance(value, int) or not 0 <= value <= most:
        raise GrootError(f"{key} is a number from 0 to {most}")
    return value
