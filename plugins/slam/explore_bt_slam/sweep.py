"""One lidar sweep, straightened into the frame of its last beam."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from explore_bt.types import Scan2D
from explore_bt_slam.arrays import Floats, Singles
from explore_bt_slam.trail import Trail

__all__ = ["Sweep", "deskew"]


class Sweep:
    """Beams that tell something, in ``base_link`` at ``stamp_s``; immutable by custom.

    Attributes:
        origins, ends: (N, 2) float32, metres: where each beam began, and where it hit or was cut off.
        hit: (N,) bool: True for a return, False for "nothing up to the end".
        reach_m: nothing of the sweep lies farther from the base.
    """

    __slots__ = ("ends", "hit", "origins", "reach_m", "stamp_s")

    def __init__(
        self,
        stamp_s: float,
        origins: NDArray[np.float32],
        ends: NDArray[np.float32],
        hit: NDArray[np.bool_],
    ) -> None:
        self.stamp_s = stamp_s
        self.origins = origins
        self.ends = ends
        self.hit = hit
        both = (np.hypot(part[:, 0], part[:, 1]) for part in (origins, ends))
        self.reach_m = max((float(part.max()) for part in both if part.size), default=0.0)

    @property
    def points(self) -> NDArray[np.float64]:
        """(M, 2) float64, metres, base frame: the returns in beam order."""
        return self.ends[self.hit].astype(np.float64)

    def cut(self, max_range_m: float) -> Sweep:
        """The same with farther returns turned into "nothing up to there"."""
        along = self.ends - self.origins
        length = np.hypot(along[:, 0], along[:, 1])
        is_far = length > max_range_m
        if not is_far.any():
            return self
        factor = np.where(is_far, max_range_m / np.maximum(length, 1e-6), 1.0)[:, None]
        ends = np.asarray(self.origins + factor * along, dtype=np.float32)
        return Sweep(self.stamp_s, self.origins, ends, self.hit & ~is_far)


def deskew(scan: Scan2D, trail: Trail, max_range_m: float) -> Sweep:
    """Move every beam to where the robot was when it was taken.

    Args:
        scan: as measured; NaN beams and returns outside the sensor's limits are dropped.
        trail: how the robot moved, ending at ``scan.stamp_s``.
        max_range_m: farther returns count as "nothing up to there".
    """
    reach_m = min(max_range_m, scan.range_max_m)
    ranges = scan.ranges_m.astype(np.float64)
    with np.errstate(invalid="ignore"):
        seen = scan.is_return & np.isfinite(scan.angles_rad)
        kept = seen | (np.isposinf(ranges) & np.isfinite(scan.angles_rad))
        hit = (seen & (ranges <= reach_m))[kept]
    ranges = np.where(hit, ranges[kept], reach_m)
    sensor = scan.T_base_sensor.as_array()
    origins, ends = _straighten(
        scan.angles_rad[kept].astype(np.float64),
        ranges,
        scan.times_s[kept].astype(np.float64),
        sensor,
        trail.times_s - scan.stamp_s,
        trail.poses,
    )
    return Sweep(scan.stamp_s, origins, ends, hit)


@njit(cache=True)
def _straighten(
    angles: Floats, ranges: Floats, times: Floats, sensor: Floats, trail_times: Floats, trail: Floats
) -> tuple[Singles, Singles]:
    """Interpolate the trail at each beam and express the beam in the trail's last pose."""
    count = angles.shape[0]
    origins = np.empty((count, 2), np.float32)
    ends = np.empty((count, 2), np.float32)
    last = trail.shape[0] - 1
    cos_e, sin_e = np.cos(trail[last, 2]), np.sin(trail[last, 2])
    for i in range(count):
        t = times[i]
        k = np.searchsorted(trail_times, t)
        if np.isnan(t) or k > last:
            x, y, yaw = trail[last, 0], trail[last, 1], trail[last, 2]
        elif k == 0:
            x, y, yaw = trail[0, 0], trail[0, 1], trail[0, 2]
        else:
            span = trail_times[k] - trail_times[k - 1]
            f = (t - trail_times[k - 1]) / span if span > 0.0 else 1.0
            x = trail[k - 1, 0] + f * (trail[k, 0] - trail[k - 1, 0])
            y = trail[k - 1, 1] + f * (trail[k, 1] - trail[k - 1, 1])
            yaw = trail[k - 1, 2] + f * (trail[k, 2] - trail[k - 1, 2])
        dx, dy = x - trail[last, 0], y - trail[last, 1]
        bx, by, byaw = cos_e * dx + sin_e * dy, -sin_e * dx + cos_e * dy, yaw - trail[last, 2]
        cos_b, sin_b = np.cos(byaw), np.sin(byaw)
        ox = bx + cos_b * sensor[0] - sin_b * sensor[1]
        oy = by + sin_b * sensor[0] + cos_b * sensor[1]
        beam = byaw + sensor[2] + angles[i]
        origins[i, 0], origins[i, 1] = ox, oy
        ends[i, 0] = ox + ranges[i] * np.cos(beam)
        ends[i, 1] = oy + ranges[i] * np.sin(beam)
    return origins, ends
