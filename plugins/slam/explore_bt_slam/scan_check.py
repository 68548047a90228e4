"""Is this a scan at all?"""

from __future__ import annotations

import math

import numpy as np

from explore_bt.types import Scan2D

__all__ = ["fault_of"]


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
