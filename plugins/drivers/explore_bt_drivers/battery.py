"""A battery that drains evenly."""

from __future__ import annotations

from typing import Protocol

from explore_bt.types import Battery

__all__ = ["BatteryGauge"]

_RATE_HZ = 1.0


class _Track(Protocol):
    """The track of a simulated body."""

    def due(self, rate_hz: float) -> int:
        """How many samples of a sensor are due by its newest state."""


class BatteryGauge:
    """Tells the charge once a second; full at the start, empty after ``life_s``."""

    def __init__(self, life_s: float) -> None:
        self._life_s = life_s
        self._samples = 0

    def begin(self, track: _Track) -> None:
        """Measure from here on: a resumed run begins in the middle."""
        self._samples = track.due(_RATE_HZ)

    def measure(self, track: _Track) -> list[Battery]:
        """The samples due since the last call."""
        due = track.due(_RATE_HZ)
        fresh = range(self._samples + 1, due + 1)
        self._samples = due
        return [Battery(k / _RATE_HZ, max(1.0 - k / _RATE_HZ / self._life_s, 0.0)) for k in fresh]
