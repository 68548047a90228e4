"""Frames of the Groot2 protocol of BehaviorTree.CPP 4.

A request is six bytes (protocol, type, number) and perhaps a second frame; the reply repeats them, adds the
tree's 16 bytes of identity, and has its payload in a second frame. What goes wrong is answered with the two
frames ``error`` and a sentence.
"""

from __future__ import annotations

import json
import struct
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

__all__ = [
    "BLACKBOARD",
    "BREAKPOINT_REACHED",
    "DISABLE_ALL_HOOKS",
    "FULL_TREE",
    "GET_TRANSITIONS",
    "HOOKS_DUMP",
    "HOOK_INSERT",
    "HOOK_REMOVE",
    "HOOK_UNLOCK",
    "PROTOCOL",
    "REMOVE_ALL_HOOKS",
    "STATUS",
    "TOGGLE_RECORDING",
    "GrootError",
    "Request",
    "error_reply",
    "notice",
    "reply",
]

PROTOCOL = 2
FULL_TREE, STATUS, BLACKBOARD = b"T", b"S", b"B"
HOOK_INSERT, HOOK_REMOVE, HOOK_UNLOCK, HOOKS_DUMP = b"I", b"R", b"U", b"D"
REMOVE_ALL_HOOKS, DISABLE_ALL_HOOKS = b"A", b"X"
TOGGLE_RECORDING, GET_TRANSITIONS = b"r", b"t"
BREAKPOINT_REACHED = b"N"

_HEADER = struct.Struct("<BcI")


class GrootError(Exception):
    """A request that cannot be answered; the client is told the sentence."""


@dataclass(frozen=True, slots=True)
class Request:
    """What a client asked.

    Attributes:
        type: one of the letters above, or one that nobody knows.
        header: the first frame.
        payload: the second frame; None without one.
    """

    type: bytes
    header: bytes
    payload: bytes | None

    @classmethod
    def parse(cls, frames: Sequence[bytes]) -> Request:
        """From the frames of a message.

        Raises:
            GrootError: they are not a request.
        """
        if not 1 <= len(frames) <= 2 or len(frames[0]) != _HEADER.size:
            raise GrootError("wrong request header")
        protocol, type_, _ = _HEADER.unpack(frames[0])
        if protocol != PROTOCOL:
            raise GrootError(f"protocol {protocol} is not spoken here; expected {PROTOCOL}")
        return cls(type_, frames[0], frames[1] if len(frames) == 2 else None)

    def text(self) -> str:
        """The second frame as text.

        Raises:
            GrootError: there is none, or it is no text.
        """
        if self.payload is None:
            raise GrootError("must be 2 parts message")
        try:
            return self.payload.decode()
        except UnicodeDecodeError:
            raise GrootError("the second part is no text") from None

    def json(self) -> Any:
        """The second frame as JSON.

        Raises:
            GrootError: it is none.
        """
        try:
            return json.loads(self.text())
        except (ValueError, RecursionError):
            raise GrootError("the second part is not JSON") from None


def reply(request: Request, tree: bytes, payload: bytes | None) -> list[bytes]:
    """The frames of an answer; ``tree`` are the 16 bytes of its identity."""
    head = [request.header + tree]
    return head if payload is None else [*head, payload]


def error_reply(sentence: str) -> list[bytes]:
    """The frames that say what is wrong."""
    return [b"error", sentence.encode()]


def notice(number: int, uid: int) -> list[bytes]:
    """The frames that tell all subscribers that a breakpoint was reached."""
    return [_HEADER.pack(PROTOCOL, BREAKPOINT_REACHED, number & 0xFFFFFFFF), str(uid).encode()]
