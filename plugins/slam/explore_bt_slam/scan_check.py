"""Is this a scan at all?"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from explore_bt.types import Scan2D

__all__ = ["fault_of", "without_body"]


def without_body(scan: Scan2D, radius_m: float) -> Scan2D:
    """The scan with returns from within the robot's footprint made invalid.

    What is seen there moves with the robot: its own parts, a bag over the lidar. Left in, it would speak
    for standing still.
    """
    mount, ranges = scan.T_base_sensor, scan.ranges_m
    with np.errstate(invalid="ignore"):
        along = mount.x * np.cos(mount.yaw_rad + scan.angles_rad) + mount.y * np.sin(
            mount.yaw_rad + scan.angles_rad
        )
        inside = ranges * ranges + 2.0 * ranges * along + mount.x**2 + mount.y**2 < radius_m**2
    if not inside.any():
        return scan
    return replace(scan, ranges_m=np.where(inside, np.float32(np.nan), ranges))


def fault_of(scan: Scan2D, last_stamp_s: float) -> str:
    """Why a scan cannot be used, in words; empty if it can."""
    if not math.isfinite(scan.stamp_s):
        return "a scan without a time stamp"
    if scan.stamp_s == last_stamp_s:
        return "a second scan with the same time stamp"
    if scan.stamp_s < last_stamp_s:
        return f"a scan {last_stamp_s - scan.stamp_s:.3f} s older than the one before"
    if scan.ranges_m.shape[0] == 0:
        return "an empty scan"
    if not (scan.is_return | np.isposinf(scan.ranges_m)).any():
        return "a scan in which every beam is invalid"
    return ""
