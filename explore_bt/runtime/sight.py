"""One scan in the ``map`` frame: how far each beam went, and from where."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from explore_bt.types import Pose2, Scan2D, Twist2

__all__ = ["REACH_M", "Sight"]

REACH_M = 5.0
"""Returns beyond this are too far apart to make out a person."""
_FEWEST = 3
_THROUGH_M, _THROUGH_SHARE = 0.2, 0.03
"""By how much (and for every metre away) a beam must have gone on behind a place to have seen through it."""


@dataclass(frozen=True, slots=True, eq=False)
class Sight:
    """What one scan shows; ``map`` frame.

    Attributes:
        stamp_s: of the scan.
        origin: (2,) metres, of the beams' middle.
        bearings: (N,) radians, ascending from the first one's.
        free_m: (N,) how far each beam went; 0 where it tells nothing.
        points: (M, 2) metres, the returns within ``REACH_M``, each taken from its own beam's place.
    """

    stamp_s: float
    origin: NDArray[np.float64]
    bearings: NDArray[np.float64]
    free_m: NDArray[np.float64]
    points: NDArray[np.float64]

    @classmethod
    def of(cls, scan: Scan2D, pose: Pose2, twist: Twist2) -> Sight | None:
        """Put the beams where they were measured; None if hardly any tells anything.

        Args:
            scan: as measured.
            pose: of the robot at the scan's stamp, ``map`` frame.
            twist: of the robot during the scan.
        """
        told = ~np.isnan(scan.ranges_m) & (scan.ranges_m >= scan.range_min_m)
        if np.count_nonzero(told) < _FEWEST:
            return None
        sensor, driven_m = scan.T_base_sensor, twist.linear_mps * scan.times_s
        yaws = pose.yaw_rad + twist.angular_rps * scan.times_s
        middle = pose.yaw_rad + 0.5 * twist.angular_rps * scan.times_s
        x = pose.x + driven_m * np.cos(middle) + sensor.x * np.cos(yaws) - sensor.y * np.sin(yaws)
        y = pose.y + driven_m * np.sin(middle) + sensor.x * np.sin(yaws) + sensor.y * np.cos(yaws)
        origins = np.column_stack((x, y))
        bearings = yaws + sensor.yaw_rad + scan.angles_rad
        ranges = np.where(told, np.minimum(scan.ranges_m, scan.range_max_m), 0.0).astype(np.float64)
        hit = scan.is_return & (scan.ranges_m <= REACH_M)
        along = np.column_stack((np.cos(bearings[hit]), np.sin(bearings[hit])))
        points = origins[hit] + ranges[hit][:, None] * along
        order = np.argsort(bearings)
        return cls(scan.stamp_s, origins.mean(axis=0), bearings[order], ranges[order], points)

    def shows(self, places: NDArray[np.float64]) -> NDArray[np.bool_]:
        """(K,) bool: whether the nearest beam to each of (K, 2) places came as far."""
        bearing, away_m = self._polar(places)
        right = np.searchsorted(self.bearings, bearing) % len(self.bearings)
        left = right - 1
        is_left = np.abs(_wrapped(self.bearings[left] - bearing)) < np.abs(
            _wrapped(self.bearings[right] - bearing)
        )
        return np.asarray(self.free_m[np.where(is_left, left, right)] >= away_m)

    def sees_through(self, places: NDArray[np.float64]) -> NDArray[np.bool_]:
        """(K,) bool: whether the beams at and beside (K, 2) places went on behind them."""
        bearing, away_m = self._polar(places)
        count, spread = len(self.bearings), self.bearings[-1] - self.bearings[0]
        right = np.searchsorted(self.bearings, bearing)
        beside = (right[:, None] + np.array([-2, -1, 0, 1])) % count
        beyond_m = self.free_m[beside].min(axis=1)
        gap = np.abs(_wrapped(self.bearings[beside[:, 1:3]] - bearing[:, None])).max(axis=1)
        is_looked_at = gap < 4.0 * spread / max(count - 1, 1)
        return np.asarray(is_looked_at & (beyond_m > away_m * (1.0 + _THROUGH_SHARE) + _THROUGH_M))

    def _polar(self, places: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """(K,) bearings, within a turn from the first beam's on, and (K,) metres of (K, 2) places."""
        off = places - self.origin
        first = self.bearings[0]
        bearing = first + np.mod(np.arctan2(off[:, 1], off[:, 0]) - first, 2.0 * math.pi)
        return bearing, np.hypot(off[:, 0], off[:, 1])


def _wrapped(angles: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.asarray((angles + math.pi) % (2.0 * math.pi) - math.pi)
