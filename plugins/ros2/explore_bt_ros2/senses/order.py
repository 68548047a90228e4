"""Measurements of several topics in the order in which they were measured."""

from __future__ import annotations

from dataclasses import replace
from typing import Generic, TypeVar

from explore_bt.types import Measurement, PointCloud, Scan2D

__all__ = ["Order"]

_STEP_S = 1e-4
_LONGEST_WAIT_S = 0.15
_EASE = 0.9

M = TypeVar("M", bound=Measurement)


class Order(Generic[M]):
    """A scan is passed on at once, with all that was measured before it; the rest waits for the scans.

    An IMU's sample takes less time to get here than a scan: so that the scan finds its place among the
    samples, they wait for as long as scans are usually under way, 0.15 s at most. What comes later still is
    stamped with the newest stamp passed on.
    """

    def __init__(self) -> None:
        self._waiting: list[M] = []
        self._lag_s = 0.0
        self._newest_s = 0.0
        self._newest_of: dict[type, float] = {}

    def sort(self, fresh: list[tuple[M, float]], now_s: float) -> list[M]:
        """What may be passed on now.

        Args:
            fresh: what has come, with the mission time of its arrival.
            now_s: mission time.
        """
        until_s = now_s - min(self._lag_s, _LONGEST_WAIT_S)
        for measurement, arrived_s in fresh:
            self._waiting.append(measurement)
            if isinstance(measurement, Scan2D | PointCloud):
                until_s = max(until_s, measurement.stamp_s)
                lag_s = max(arrived_s - measurement.stamp_s, 0.0)
                self._lag_s = max(lag_s, _EASE * self._lag_s + (1.0 - _EASE) * lag_s)
        self._waiting.sort(key=lambda each: each.stamp_s)
        due = [each for each in self._waiting if each.stamp_s <= until_s]
        self._waiting = self._waiting[len(due) :]
        return [self._stamped(each) for each in due]

    def _stamped(self, measurement: M) -> M:
        kind = type(measurement)
        earliest_s = max(self._newest_s, self._newest_of.get(kind, -1.0) + _STEP_S)
        stamp_s = max(measurement.stamp_s, earliest_s)
        self._newest_s = self._newest_of[kind] = stamp_s
        return measurement if stamp_s == measurement.stamp_s else replace(measurement, stamp_s=stamp_s)
