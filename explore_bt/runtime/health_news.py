"""When a change of health is worth telling."""

from __future__ import annotations

from explore_bt.types import Estimate, Health

__all__ = ["HealthNews"]

_CALM_S = 1.0
_SEVERITY = {Health.OK: 0, Health.DEGRADED: 1, Health.LOST: 2}


class HealthNews:
    """Worse is told at once; better once it has lasted a second: scans at a corridor's end alternate."""

    def __init__(self) -> None:
        self._told = Health.OK
        self._told_s = 0.0
        self._better_since_s: float | None = None

    def of(self, estimate: Estimate, now_s: float) -> str:
        """One line for the log, empty if there is nothing new."""
        health, before = estimate.health, self._told
        if _SEVERITY[health] >= _SEVERITY[before]:
            self._better_since_s = None
            if health is before:
                return ""
        else:
            if self._better_since_s is None:
                self._better_since_s = now_s
            if now_s - self._better_since_s < _CALM_S:
                return ""
        lasted = ""
        if self._better_since_s is not None:
            lasted = f" after {self._better_since_s - self._told_s:.1f} s"
            now_s = self._better_since_s
        self._told, self._told_s, self._better_since_s = health, now_s, None
        return f"{before} → {health}{lasted}" + (f": {estimate.reason}" if estimate.reason else "")
