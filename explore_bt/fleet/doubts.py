"""What speaks against two maps lying as they seem to, whoever says that they do."""

from __future__ import annotations

import math
from collections.abc import Sequence

import cv2
import numpy as np
from numpy.typing import NDArray

from explore_bt.fleet.mosaic import Mosaic
from explore_bt.fleet.tiles import cut_tile, first_cell
from explore_bt.types import FREE, OCCUPIED, UNKNOWN, Mate, OccupancyGrid, Pose2, Scan2D

__all__ = ["Unseen", "quarrel"]

_SLACK_CELLS = 4
_MOST_CELLS = 40
"""Of wall that the other has found free: a door or two, some chairs; 2 m at 5 cm."""
_MOST_SHARE = 0.04
_FAR_M = 3.5
_BEYOND_M = 0.3
_SCANS = 15
_LEAST_BEAMS = 3
_LATE_S, _LATE_M = 1.0, 0.1
"""A word that is older, or since which the mate has driven farther, does not say where it is now."""


def quarrel(own: OccupancyGrid, mosaic: Mosaic) -> str:
    """In words, how much of either's walls is free floor in the other's map; empty if no more than usual.

    Args:
        own: one's own map.
        mosaic: the mate's, laid into it.
    """
    against = both = 0
    for place in mosaic.places:
        ours = cut_tile(own, place, first_cell(own))
        if (ours == UNKNOWN).all():
            continue
        theirs = mosaic.drawn(place)
        known = (theirs != UNKNOWN) & (ours != UNKNOWN)
        walls = known & ((theirs == OCCUPIED) | (ours == OCCUPIED))
        both += int(np.count_nonzero(walls))
        against += _gone(ours, theirs) + _gone(theirs, ours)
    if against <= _MOST_CELLS or against <= _MOST_SHARE * both:
        return ""
    length_m = against * own.resolution_m
    return f"{length_m:.1f} m of wall of one map are free floor in the other"


def _gone(walls: NDArray[np.int8], other: NDArray[np.int8]) -> int:
    """Cells of wall that are free in the other map, with no wall of it about; not at the rim of a tile."""
    kernel = np.ones((2 * _SLACK_CELLS + 1,) * 2, dtype=np.uint8)
    about = cv2.dilate((other == OCCUPIED).astype(np.uint8), kernel)
    gone = (walls == OCCUPIED) & (other == FREE) & (about == 0)
    rim = _SLACK_CELLS
    return int(np.count_nonzero(gone[rim:-rim, rim:-rim]))


class Unseen:
    """Mates that say they stand where the lidar looks right through them."""

    def __init__(self) -> None:
        self._counts: dict[str, int] = {}

    def look(self, scan: Scan2D, pose: Pose2, mates: Sequence[Mate], radius_m: float) -> dict[str, str]:
        """Who cannot be where it says, after a row of scans; with what was seen, in words.

        Args:
            scan: as measured.
            pose: of the base at its stamp, ``map`` frame.
            mates: whose word is fresh, where they would be.
            radius_m: of the own footprint.
        """
        found = {}
        for mate in mates:
            late_s = abs(scan.stamp_s - mate.stamp_s)
            if late_s > _LATE_S or late_s * abs(mate.twist.linear_mps) > _LATE_M:
                continue
            verdict = _is_there(scan, pose, mate, radius_m)
            if verdict is not None:
                self._counts[mate.name] = 0 if verdict else self._counts.get(mate.name, 0) + 1
            if self._counts.get(mate.name, 0) >= _SCANS:
                self._counts[mate.name] = 0
                away_m = math.dist(pose.xy, mate.T_map_base.xy)
                found[mate.name] = f"it says that it stands {away_m:.1f} m away, and nothing stands there"
        return found


def _is_there(scan: Scan2D, pose: Pose2, mate: Mate, radius_m: float) -> bool | None:
    """Whether a mate is seen where it says; None where the scan does not tell."""
    x, y = pose.inverse().apply(np.array([mate.at(scan.stamp_s)]))[0].tolist()
    sensor = scan.T_base_sensor
    away_m = math.hypot(x, y)
    if away_m < radius_m:
        return False  # it would stand in the middle of this robot
    if away_m > _FAR_M or away_m < radius_m + mate.radius_m + 0.1:
        return None
    lx, ly = sensor.inverse().apply(np.array([[x, y]]))[0].tolist()
    far_m = math.hypot(lx, ly)
    half_rad = math.asin(min(0.5 * mate.radius_m / far_m, 1.0))
    off = np.abs((scan.angles_rad - math.atan2(ly, lx) + np.pi) % (2.0 * np.pi) - np.pi)
    ranges = scan.ranges_m[(off < half_rad) & ~scan.is_invalid].astype(np.float64)
    if len(ranges) < _LEAST_BEAMS or scan.range_max_m < far_m + mate.radius_m:
        return None
    if (ranges > far_m + mate.radius_m + _BEYOND_M).all():
        return False
    near_m = np.abs(ranges - far_m) < mate.radius_m + 0.15
    return True if near_m.any() else None
