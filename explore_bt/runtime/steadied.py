"""A scan with less noise where it matters most: close by."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numba import njit
from numpy.typing import NDArray

from explore_bt.types import Scan2D

__all__ = ["steadied"]

SMOOTHED_WIDTH_M = 0.02
"""Returns that lie so close together are one surface; a thing wider than half of this is never lost."""


def steadied(scan: Scan2D) -> Scan2D:
    """Each return as the median of the returns within 1 cm to either side along the surface.

    Close by, many beams hit the same few centimetres, and the least of many noisy ranges is always too
    short: a robot that believed it would refuse passages it fits through. Farther off than a beam's step
    of 1 cm (0.6 m at one degree) nothing is changed.

    Returns:
        The scan with ``ranges_m`` replaced; NaN and +inf stay as they are.
    """
    if scan.ranges_m.size < 3:
        return scan
    step_rad = float(np.abs(np.median(np.diff(scan.angles_rad))))
    return replace(scan, ranges_m=_medians(scan.ranges_m, scan.is_return, max(step_rad, 1e-6)))


@njit(cache=True)
def _medians(
    ranges: NDArray[np.float32], is_return: NDArray[np.bool_], step_rad: float
) -> NDArray[np.float32]:
    out = ranges.copy()
    count = ranges.shape[0]
    for i in range(count):
        if not is_return[i]:
            continue
        half = int(0.5 * SMOOTHED_WIDTH_M / (step_rad * ranges[i]))
        if half == 0:
            continue
        first, last = max(0, i - half), min(count, i + half + 1)
        near = ranges[first:last][is_return[first:last]]
        out[i] = np.median(near)
    return out
