"""A scan as seen about the robot's centre: which angles its beams block, and which nobody looked in."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from explore_bt.types import Scan2D

__all__ = ["Beams"]

_TURN = 2.0 * math.pi
_JOINED = 1.5  # beams up to so many steps apart are neighbours; beyond, a beam is missing
_TOUCH_M = 1e-6  # a return at l exactly is free, however its point was rounded
_WIDEST_CELL_RAD = math.radians(10.0)  # no beam speaks for more than this, however few there are


@dataclass(frozen=True, slots=True, eq=False)
class Beams:
    """The beams of one scan in the order of their directions, all in ``base_link``, radians and metres.

    Attributes:
        directions_rad: (N,) float64, rising, within one turn.
        spans_rad: (N,) float64, from each direction to the next one round the circle.
        is_free, is_invalid: (N,) bool; a beam that is neither met something nearer than l.
        bearings_rad, distances_m: (M,) float64, returns nearer than l, about the robot's centre.
        cell_rad: half a beam's step.
    """

    directions_rad: NDArray[np.float64]
    spans_rad: NDArray[np.float64]
    is_free: NDArray[np.bool_]
    is_invalid: NDArray[np.bool_]
    bearings_rad: NDArray[np.float64]
    distances_m: NDArray[np.float64]
    cell_rad: float

    @staticmethod
    def of(scan: Scan2D, detection_range_m: float) -> Beams:
        """The beams of a scan; blocked are those that met something nearer than l."""
        around = (scan.angles_rad + scan.T_base_sensor.yaw_rad) % _TURN
        order = np.argsort(around, kind="stable")
        directions = around[order]
        spans = np.diff(directions, append=directions[:1] + _TURN)
        points = scan.points()
        distances = np.hypot(points[:, 0], points[:, 1])
        near = distances < detection_range_m - _TOUCH_M
        is_blocked = np.zeros(around.shape, dtype=np.bool_)
        is_blocked[np.flatnonzero(scan.is_return)[near]] = True
        return Beams(
            directions_rad=directions,
            spans_rad=spans,
            is_free=~(is_blocked | scan.is_invalid)[order],
            is_invalid=scan.is_invalid[order],
            bearings_rad=np.arctan2(points[near, 1], points[near, 0]),
            distances_m=distances[near],
            cell_rad=min(0.5 * float(np.median(spans)), 0.5 * _WIDEST_CELL_RAD) if spans.size else 0.0,
        )

    @property
    def count(self) -> int:
        """How many beams there are."""
        return self.directions_rad.size

    def shadows(self, radius_m: float) -> NDArray[np.float64]:
        """(M, 2): bearings at which a disc of this radius would run into a return, first and last."""
        ratio = np.minimum(radius_m / np.maximum(self.distances_m, np.finfo(np.float64).tiny), 1.0)
        half = np.maximum(np.arcsin(ratio), self.cell_rad)
        return np.column_stack((self.bearings_rad - half, self.bearings_rad + half))

    def unknown_cells(self, bridge_beams: int) -> NDArray[np.float64]:
        """(K, 2): angular cells of the invalid beams that no bridge covers, first and last angle."""
        unknown = np.flatnonzero(self.is_invalid & ~self._bridged(bridge_beams))
        reach = np.where(self._is_joined, 0.5 * self.spans_rad, self.cell_rad)
        directions = self.directions_rad[unknown]
        return np.column_stack((directions - reach[unknown - 1], directions + reach[unknown]))

    def gaps(self) -> NDArray[np.float64]:
        """(K, 2): angles between beams that are not neighbours, less each one's own cell."""
        apart = ~self._is_joined
        start = self.directions_rad[apart]
        return np.column_stack((start + self.cell_rad, start + self.spans_rad[apart] - self.cell_rad))

    @property
    def _is_joined(self) -> NDArray[np.bool_]:
        return self.spans_rad <= 2.0 * _JOINED * self.cell_rad

    def _bridged(self, bridge_beams: int) -> NDArray[np.bool_]:
        """(N,) bool: invalid beams in short runs between two free neighbours."""
        bridged = np.zeros(self.count, dtype=np.bool_)
        joined = self._is_joined
        valid = np.flatnonzero(~self.is_invalid)
        for before, after in zip(valid, np.roll(valid, -1), strict=True):
            length = (after - before - 1) % self.count
            if not 0 < length <= bridge_beams or not (self.is_free[before] and self.is_free[after]):
                continue
            run = (before + np.arange(length + 1)) % self.count
            if joined[run].all():
                bridged[run[1:]] = True
        return bridged
