"""Paths and waypoints."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from explore_bt.types.pose import Pose2

__all__ = ["Path", "Waypoint", "way_along"]


def way_along(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """(N,) float64: the way from the first point to each, in the unit of the points.

    Args:
        points: (N, 2) float64 along a line; more columns take no part.
    """
    steps = np.diff(points[:, :2], axis=0)
    return np.concatenate((np.zeros(min(len(points), 1)), np.cumsum(np.hypot(steps[:, 0], steps[:, 1]))))


@dataclass(frozen=True, slots=True, eq=False)
class Path:
    """Where to drive, in the ``map`` frame.

    Attributes:
        poses: (N, 3) float64, N >= 1: x, y in metres, yaw in radians along the direction of travel.
            The yaw of the last pose is the heading to arrive with; a path of one pose is a turn in
            place.
        clearance_m: (N,) float64: distance from each pose to the nearest obstacle or unknown cell.
    """

    poses: NDArray[np.float64]
    clearance_m: NDArray[np.float64]

    @property
    def goal(self) -> Pose2:
        """The last pose."""
        x, y, yaw = self.poses[-1]
        return Pose2(float(x), float(y), float(yaw))

    @property
    def length_m(self) -> float:
        """Metres along the path."""
        return float(way_along(self.poses)[-1])

    @property
    def min_clearance_m(self) -> float:
        """The narrowest place on the way, metres."""
        return float(self.clearance_m.min())


@dataclass(frozen=True, slots=True)
class Waypoint:
    """A pose worth going to, and what is known about it: the paper's (p^k, r^{k,z}).

    Attributes:
        reason: why it was chosen, a word or two.
        expected_gain_m2: new floor expected to be seen from it.
        looks_at: (x, y) metres of the frontier it is meant to see; None if it is not about one.
        via: (x, y) metres of places to pass on the way there, in this order.
    """

    pose: Pose2
    reason: str = ""
    expected_gain_m2: float = 0.0
    looks_at: tuple[float, float] | None = None
    via: tuple[tuple[float, float], ...] = ()

    @property
    def position(self) -> tuple[float, float]:
        """p^k: x, y in metres, ``map`` frame."""
        return self.pose.xy

    @property
    def heading_rad(self) -> float:
        """r^{k,z}: radians, ``map`` frame."""
        return self.pose.yaw_rad
