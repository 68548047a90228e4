"""Free sectors: the directions a circular footprint can safely leave in."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from explore_bt.exploration.arguments import require_at_least, require_positive
from explore_bt.exploration.beams import Beams
from explore_bt.types import Scan2D, wrap_angle

__all__ = ["FreeSector", "find_free_sectors", "order_by_safety"]

_QUARTER = math.pi / 2.0
_NO_WIDTH_RAD = 1e-9  # where two obstacles' shadows only touch there is no direction between them
_SAME_WIDTH_RAD = math.radians(1.0)  # about the step of a lidar: finer differences are chance
_SAME_CLEARANCE_M = 0.01

Intervals = NDArray[np.float64]  # (K, 2): first and last angle, radians


@dataclass(frozen=True, slots=True)
class FreeSector:
    """q_i = [q_i^−, q_i^+]: a maximal interval of passable directions, in ``base_link``.

    Angles count from the robot's x axis, counter-clockwise, and are not wrapped: a look to the rear gives
    sectors around π.

    Attributes:
        start_rad: q_i^−.
        width_rad: q_i = q_i^+ − q_i^−, in (0, π].
        bisector_clearance_m: distance from the bisector, robot to l, to the nearest return ahead; at most
            the lidar's range.
    """

    start_rad: float
    width_rad: float
    bisector_clearance_m: float

    @property
    def end_rad(self) -> float:
        """q_i^+."""
        return self.start_rad + self.width_rad

    @property
    def bisector_rad(self) -> float:
        """q_i^− + q_i/2, the dichotomous angle: halfway between the obstacles that bound the sector."""
        return self.start_rad + 0.5 * self.width_rad

    def contains(self, direction_rad: float) -> bool:
        """Whether a direction in ``base_link`` lies in the sector, its bounds included."""
        return abs(wrap_angle(direction_rad - self.bisector_rad)) <= 0.5 * self.width_rad


def find_free_sectors(
    scan: Scan2D,
    *,
    detection_range_m: float,
    footprint_radius_m: float,
    margin_m: float = 0.0,
    facing_rad: float = 0.0,
    bridge_beams: int = 0,
) -> tuple[FreeSector, ...]:
    """The free sectors of a semicircle, the safest first (steps 1 and 2 of ALGORITHM.md).

    A return at ρ < l from the robot's centre blocks ±asin((r + margin)/ρ) about its bearing, or ±90° where
    ρ ≤ r + margin, and never less than its own beam's angular cell. No return, and a return at l or
    beyond, is free. An invalid beam, and a direction no beam looks in, is unknown and hence not safe: it
    blocks its own angular cell (half a step either way), no more.

    Args:
        scan: one sweep; returns are taken about the robot's centre, whatever the sensor's place on it.
        detection_range_m: l.
        footprint_radius_m: r.
        margin_m: added to r.
        facing_rad: middle of the semicircle in ``base_link``; π is the look to the rear.
        bridge_beams: up to so many invalid beams in a row between two free ones count as free. Lidars drop
            single beams by chance; without the bridge each drop-out splits a sector and moves its
            bisector. 0 is the literal reading.

    Returns:
        Sectors in ``base_link``, as ordered by :func:`order_by_safety`; none from a scan without beams.

    Raises:
        ArgumentError: if l is not above zero, or r, margin or bridge_beams is below zero.
    """
    require_positive(detection_range_m=detection_range_m)
    require_at_least(0, footprint_radius_m=footprint_radius_m, margin_m=margin_m, bridge_beams=bridge_beams)
    beams = Beams.of(scan, detection_range_m)
    if beams.count == 0:
        return ()
    blocked = np.concatenate(
        (beams.shadows(footprint_radius_m + margin_m), beams.unknown_cells(bridge_beams), beams.gaps())
    )
    returns = scan.points()

    def sector(first: float, last: float) -> FreeSector:
        direction = facing_rad + 0.5 * (first + last)
        clearance = _clearance_along(returns, direction, detection_range_m, scan.range_max_m)
        return FreeSector(facing_rad + first, last - first, clearance)

    free = _complement(blocked - facing_rad, -_QUARTER, _QUARTER)
    return order_by_safety((sector(first, last) for first, last in free.tolist()), facing_rad)


def order_by_safety(
    sectors: Iterable[FreeSector],
    facing_rad: float = 0.0,
    *,
    width_tolerance_rad: float = _SAME_WIDTH_RAD,
    clearance_tolerance_m: float = _SAME_CLEARANCE_M,
) -> tuple[FreeSector, ...]:
    """Widest first; ties by clearance along the bisector, then by the smaller turn from ``facing_rad``.

    A tie is anything within the tolerance of the first of its group, so the order is one and the same
    however the sectors come in.
    """

    def turn_rad(sector: FreeSector) -> tuple[float, float]:
        return (abs(wrap_angle(sector.bisector_rad - facing_rad)), sector.start_rad)

    ordered: list[FreeSector] = []
    for as_wide in _tied(sectors, lambda s: s.width_rad, width_tolerance_rad):
        for as_clear in _tied(as_wide, lambda s: s.bisector_clearance_m, clearance_tolerance_m):
            ordered += sorted(as_clear, key=turn_rad)
    return tuple(ordered)


def _tied(
    sectors: Iterable[FreeSector], size: Callable[[FreeSector], float], tolerance: float
) -> list[list[FreeSector]]:
    """Groups of falling size, each within the tolerance of its first."""
    groups: list[list[FreeSector]] = []
    for sector in sorted(sectors, key=size, reverse=True):
        if groups and size(groups[-1][0]) <= size(sector) + tolerance:
            groups[-1].append(sector)
        else:
            groups.append([sector])
    return groups


def _complement(blocked: Intervals, first: float, last: float) -> Intervals:
    """What a union of intervals on the circle leaves of [first, last], in rising order."""
    turn = 2.0 * math.pi
    lap = np.floor((blocked[:, :1] + math.pi) / turn) * turn
    unrolled = np.concatenate([blocked - lap + shift for shift in (-turn, 0.0, turn)])
    unrolled = unrolled[np.argsort(unrolled[:, 0], kind="stable")]
    ends = np.concatenate(([first], np.maximum(np.maximum.accumulate(unrolled[:, 1]), first)))
    starts = np.concatenate((np.minimum(unrolled[:, 0], last), [last]))
    is_open = starts - ends > _NO_WIDTH_RAD
    return np.column_stack((ends[is_open], starts[is_open]))


def _clearance_along(
    returns: NDArray[np.float64], direction_rad: float, length_m: float, most_m: float
) -> float:
    """Distance from a segment that starts at the robot to the nearest return ahead of it, metres."""
    cos, sin = math.cos(direction_rad), math.sin(direction_rad)
    along = returns[:, 0] * cos + returns[:, 1] * sin
    across = returns[:, 1] * cos - returns[:, 0] * sin
    distance = np.hypot(across, np.maximum(along - length_m, 0.0))[along > 0.0]
    return float(distance.min(initial=most_m))
