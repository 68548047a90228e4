"""Time, as the mission sees it: nobody calls ``time.time()`` or sleeps but the clocks here."""

from __future__ import annotations

import time
from abc import ABC, abstractmethod

__all__ = ["Clock", "ManualClock", "WallClock"]


class Clock(ABC):
    """Seconds since the start of the mission; waiting is how time passes."""

    @property
    @abstractmethod
    def is_simulated(self) -> bool:
        """Whether the time stands still between waits (so that a debugger can hold it)."""

    @abstractmethod
    def now_s(self) -> float:
        """The present time, seconds, monotonic."""

    @abstractmethod
    def wait_until(self, time_s: float) -> None:
        """Return when ``now_s() >= time_s``; a simulator advances its world meanwhile."""


class WallClock(Clock):
    """Real time, counted from the clock's construction.

    Args:
        begin_s: what the clock shows then; above 0 where a run is resumed.
    """

    def __init__(self, begin_s: float = 0.0) -> None:
        self._origin_s = time.monotonic() - begin_s

    @property
    def is_simulated(self) -> bool:
        """Never: nobody can hold real time."""
        return False

    def now_s(self) -> float:
        """Seconds since construction, and ``begin_s``."""
        return time.monotonic() - self._origin_s

    def wait_until(self, time_s: float) -> None:
        """Sleep until ``time_s``."""
        remaining_s = time_s - self.now_s()
        if remaining_s > 0.0:
            time.sleep(remaining_s)


class ManualClock(Clock):
    """A clock that jumps to the time waited for; simulators advance their world on top of it.

    Args:
        begin_s: what it shows first; above 0 where a run is resumed.
    """

    def __init__(self, begin_s: float = 0.0) -> None:
        self._now_s = begin_s

    @property
    def is_simulated(self) -> bool:
        """Always: it moves only when somebody waits."""
        return True

    def now_s(self) -> float:
        """The time last waited for, seconds."""
        return self._now_s

    def wait_until(self, time_s: float) -> None:
        """Jump to ``time_s`` (never back)."""
        self._now_s = max(self._now_s, time_s)
