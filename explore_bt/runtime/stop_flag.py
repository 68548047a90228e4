"""The paper's ``stop_exploration``: raised by a person, honoured within one tick."""

from __future__ import annotations

import threading

__all__ = ["StopFlag"]


class StopFlag:
    """A flag that any thread or signal handler may raise; it is never lowered."""

    def __init__(self) -> None:
        self._event = threading.Event()
        self._reason = ""

    def raise_flag(self, reason: str) -> None:
        """Ask for a safe stop; the first reason counts."""
        if not self._event.is_set():
            self._reason = reason
            self._event.set()

    @property
    def is_raised(self) -> bool:
        """Whether somebody asked."""
        return self._event.is_set()

    @property
    def reason(self) -> str:
        """Who asked, in words; empty while nobody has."""
        return self._reason
