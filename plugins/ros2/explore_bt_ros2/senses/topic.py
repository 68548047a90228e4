"""One topic that is listened to: what came, what was refused, for how long it has been silent."""

from __future__ import annotations

import threading
from collections import deque
from typing import Any

__all__ = ["Topic"]

_WAITING = 500


class Topic:
    """Messages are put in by the ROS thread and taken by the control thread.

    Attributes:
        name: with its namespace.
        kind: ``sensor_msgs/msg/LaserScan``.
        needed: whether the robot may not drive before it has spoken.
        passed_over: messages that were dropped because nobody had taken them.
    """

    def __init__(self, name: str, kind: str, needed: bool, newest: int = _WAITING) -> None:
        self.name = name
        self.kind = kind
        self.needed = needed
        self._waiting: deque[tuple[Any, float]] = deque(maxlen=newest)
        self._lock = threading.Lock()
        self.passed_over = 0
        self._refusal = ""
        self._good_s: float | None = None
        self._suspect_until_s = 0.0
        self._suspicion = ""

    def put(self, message: Any, now_s: float) -> None:
        """A message has arrived; the oldest makes way where too many wait."""
        with self._lock:
            self.passed_over += len(self._waiting) == self._waiting.maxlen
            self._waiting.append((message, now_s))

    @property
    def refusal(self) -> str:
        """Why the newest message was refused; empty after a good one."""
        return self._refusal

    @property
    def is_heard(self) -> bool:
        """Whether a message waits, or was good."""
        return bool(self._waiting) or self._good_s is not None

    def take(self) -> list[tuple[Any, float]]:
        """What has arrived since the last time, with the mission time of its arrival."""
        with self._lock:
            taken = list(self._waiting)
            self._waiting.clear()
        return taken

    def accept(self, arrived_s: float) -> None:
        """A message was good."""
        self._good_s, self._refusal = arrived_s, ""

    def refuse(self, words: str) -> None:
        """A message was not, and why."""
        self._refusal = words

    def suspect(self, words: str, until_s: float) -> None:
        """Messages are taken, but are no ground to drive on for a while."""
        self._suspicion, self._suspect_until_s = words, until_s

    def fault(self, now_s: float, silence_s: float, why: str) -> str:
        """Why this topic holds the robot, in words; empty if it does not.

        Args:
            now_s: mission time.
            silence_s: it may be silent for so long.
            why: what is known about the silence.
        """
        if now_s < self._suspect_until_s:
            return f"{self.name}: {self._suspicion}"
        if self._good_s is None and not (self.needed or self._refusal):
            return ""
        if self._good_s is not None and now_s - self._good_s <= silence_s:
            return ""
        told = self._refusal or why
        if self._good_s is None:
            return f"{self.name}: {told or 'nothing has been heard yet'}"
        return f"{self.name}: nothing good for {now_s - self._good_s:.1f} s{f' ({told})' if told else ''}"
