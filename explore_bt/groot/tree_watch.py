"""One robot's tree as its observers were shown it last: statuses, blackboard, transitions."""

from __future__ import annotations

import struct
import threading
from collections import deque
from collections.abc import Mapping, Sequence

from explore_bt.interfaces import NodeInfo, NodeState, RobotSnapshot
from explore_bt.mission.btcpp import uid_of
from explore_bt.recording import STATUS_BYTES, transition_record

__all__ = ["TreeWatch"]

_IDLE_AFTER = 10
_MOST_TRANSITIONS = 20_000
_ENDED = ("success", "failure")


class TreeWatch:
    """Written by the tick thread, read by the server's; neither waits for more than a copy of a list."""

    def __init__(self, nodes: Sequence[NodeInfo]) -> None:
        self._uids = [uid_of(node) for node in nodes]
        self._bytes = [0] * len(nodes)
        self._states = ["idle"] * len(nodes)
        self._blackboard: Mapping[str, object] = {}
        self._lock = threading.Lock()
        self._now_s = 0.0
        self._recorded_from_s: float | None = None
        self._transitions: deque[bytes] = deque(maxlen=_MOST_TRANSITIONS)

    def on_tick(self, stamp_s: float, robot: RobotSnapshot) -> None:
        """Take in what a tick has changed."""
        with self._lock:
            self._now_s, self._blackboard = stamp_s, robot.blackboard
            for index, node in enumerate(robot.nodes):
                before = self._states[index]
                if node.ticks and before == node.status and node.status in _ENDED:
                    self._note(index, "idle")  # it began anew, and ended the same way
                    self._note(index, node.status)
                elif node.status != before:
                    self._note(index, node.status)

    @property
    def blackboard(self) -> Mapping[str, object]:
        """Entries after the last tick; every value is immutable."""
        return self._blackboard

    def statuses(self, now: Sequence[NodeState] | None = None) -> bytes:
        """Three bytes a node: number and status; a node that has become idle shows what it was before.

        Args:
            now: the nodes in the middle of a tick; else they are as after the last one.
        """
        with self._lock:
            shown = list(self._bytes)
        for index, node in enumerate(now or ()):
            shown[index] = _shown(shown[index], node.status)
        return b"".join(struct.pack("<HB", uid, byte) for uid, byte in zip(self._uids, shown, strict=True))

    def start_recording(self) -> None:
        """Keep transitions from now on; times count from here."""
        with self._lock:
            self._recorded_from_s = self._now_s
            self._transitions.clear()

    def stop_recording(self) -> None:
        """Keep no more; those kept can still be taken."""
        with self._lock:
            self._recorded_from_s = None

    def take_transitions(self) -> bytes:
        """Those kept since they were taken last: nine bytes each, as in a ``.btlog``."""
        with self._lock:
            taken = b"".join(self._transitions)
            self._transitions.clear()
        return taken

    def _note(self, index: int, status: str) -> None:
        self._states[index] = status
        self._bytes[index] = _shown(self._bytes[index], status)
        if self._recorded_from_s is not None:
            stamp_s = self._now_s - self._recorded_from_s
            self._transitions.append(transition_record(stamp_s, self._uids[index], status))


def _shown(before: int, status: str) -> int:
    """The byte for a status, after the byte that was shown before."""
    if status != "idle" or before == 0 or before > _IDLE_AFTER:
        return STATUS_BYTES[status] if status != "idle" else before
    return _IDLE_AFTER + before
