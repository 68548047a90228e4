"""How far the estimate can be trusted, from what became of the last scans."""

from __future__ import annotations

import math

from explore_bt.types import Health

__all__ = ["HealthMonitor"]

_LATE_S = 0.5
_LOST_S = 1.0
_LOST_SCANS = 10


class HealthMonitor:
    """``ok`` after a good scan, ``degraded`` after a bad one, ``lost`` after a second of bad ones or none.

    Ten bad scans in a row count as a second, in case their stamps stand still.
    """

    def __init__(self) -> None:
        self._good_s: float | None = None
        self._now_s = -math.inf
        self._problem = ""
        self._weakness = ""
        self._bad_in_a_row = 0

    @property
    def state(self) -> tuple[Health, str]:
        """Health, and in words why it is not ``ok``."""
        if self._good_s is None:
            return (Health.OK, "") if not self._problem else (Health.DEGRADED, self._problem)
        silent_s = self._now_s - self._good_s
        problem = self._problem or f"no scan for {silent_s:.1f} s"
        if silent_s > _LOST_S:
            return Health.LOST, f"{problem}, for {silent_s:.1f} s now" if self._problem else problem
        if self._bad_in_a_row > _LOST_SCANS:
            return Health.LOST, f"{problem}, {self._bad_in_a_row} scans in a row"
        if self._problem or silent_s > _LATE_S:
            return Health.DEGRADED, problem
        return (Health.DEGRADED, self._weakness) if self._weakness else (Health.OK, "")

    def good(self, stamp_s: float, weakness: str = "") -> None:
        """A scan was registered; ``weakness`` says what it left open."""
        self._good_s = stamp_s
        self._now_s = max(stamp_s, self._now_s) if self._now_s - stamp_s < _LATE_S else stamp_s
        self._problem, self._weakness, self._bad_in_a_row = "", weakness, 0

    def bad(self, stamp_s: float, problem: str) -> None:
        """A measurement could not be used."""
        self.passed(stamp_s)
        if self._good_s is None:
            self._good_s = stamp_s
        self._problem = problem
        self._bad_in_a_row += 1

    def passed(self, stamp_s: float) -> None:
        """Time has come to here."""
        self._now_s = max(self._now_s, stamp_s)
