"""What the mission's limits leave a robot to spend."""

from __future__ import annotations

from collections.abc import Mapping
from typing import cast

from explore_bt.mission import LimitsSpec
from explore_bt.types import Battery, Budget

__all__ = ["Purse"]

_LEARNING_S = 30.0


class Purse:
    """Keeps the budgets of one robot; what its battery gives a second is learnt as it drains."""

    def __init__(self, limits: LimitsSpec) -> None:
        self._limits = limits
        self._first: Battery | None = None
        self._last: Battery | None = None

    def take(self, battery: Battery) -> None:
        """The newest state of charge."""
        self._first = self._first or battery
        self._last = battery

    @property
    def charge(self) -> float | None:
        """The battery's newest state of charge, a share; None where nobody measures it."""
        return None if self._last is None else self._last.charge

    def budgets(self, now_s: float, distance_m: float) -> tuple[Budget, ...]:
        """All that are limited; the battery's counts what is above its reserve, in percent of the charge."""
        limits, found = self._limits, []
        if limits.time_s is not None:
            found.append(Budget("time", "s", limits.time_s, limits.time_s - now_s, per_s=1.0))
        if limits.distance_m is not None:
            found.append(
                Budget("distance", "m", limits.distance_m, limits.distance_m - distance_m, per_m=1.0)
            )
        if limits.battery_reserve is not None and self._first is not None and self._last is not None:
            whole, left = (100.0 * (at.charge - limits.battery_reserve) for at in (self._first, self._last))
            found.append(Budget("battery", "%", whole, left, per_s=self._drain_per_s(whole - left)))
        return tuple(found)

    def memory(self) -> Mapping[str, object]:
        """What the battery gave so far."""
        return {"first": self._first, "last": self._last}

    def restore(self, memory: Mapping[str, object]) -> None:
        """Go on learning, from the next reading on."""
        self._first, self._last = (cast(Battery | None, memory[name]) for name in ("first", "last"))

    def _drain_per_s(self, spent: float) -> float:
        assert self._first is not None
        assert self._last is not None
        elapsed_s = self._last.stamp_s - self._first.stamp_s
        return max(spent, 0.0) / elapsed_s if elapsed_s >= _LEARNING_S else 0.0
