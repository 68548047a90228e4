"""A 3D sweep as a level robot would have seen it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray

from explore_bt.levelling.arrays import Floats, Singles
from explore_bt.levelling.attitude import AttitudeFilter
from explore_bt.types import PointCloud

__all__ = ["LevelCloud", "fault_of_cloud", "level"]


@dataclass(frozen=True, slots=True, eq=False)
class LevelCloud:
    """Valid returns in level axes: z points up from the floor, x where the robot faces.

    Attributes:
        stamp_s: of the sweep.
        times_s: (N,) float64 relative to it.
        own: (N, 3) float32, metres: each point about the ``base_link`` of its own moment and heading.
        ends: (N, 3) float32, metres: the same turned to the heading at the stamp; the robot's way during the
            sweep is not yet in it.
        origins: (N, 3) float32, metres: the sensor at each point's moment, like ``ends``.
    """

    stamp_s: float
    times_s: NDArray[np.float64]
    own: NDArray[np.float32]
    ends: NDArray[np.float32]
    origins: NDArray[np.float32]

    def moved(self, velocity_mps: NDArray[np.float64]) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        """Origins and ends in ``base_link`` at the stamp, for a robot that went at this speed, (2,) m/s."""
        way = (self.times_s[:, None] * velocity_mps).astype(np.float32)
        origins, ends = self.origins.copy(), self.ends.copy()
        origins[:, :2] += way
        ends[:, :2] += way
        return origins, ends


def fault_of_cloud(cloud: PointCloud) -> str:
    """Why a sweep cannot be read at all, in words; empty if it can."""
    count = cloud.points.shape[0]
    if cloud.points.shape != (count, 3) or cloud.times_s.shape != (count,):
        return f"a cloud of shape {cloud.points.shape} with times of shape {cloud.times_s.shape}"
    if cloud.T_base_sensor.shape != (4, 4) or not np.isfinite(cloud.T_base_sensor).all():
        return "a cloud whose sensor has no place on the robot"
    return ""


def level(cloud: PointCloud, attitude: AttitudeFilter, base_height_m: float, reach_m: float) -> LevelCloud:
    """Turn each point by the attitude at its own time; NaN and far returns are dropped.

    Args:
        cloud: as measured.
        attitude: that has heard the IMU up to the cloud's stamp.
        base_height_m: of ``base_link`` above the floor.
        reach_m: returns farther from the sensor are dropped.
    """
    times, inverse = np.unique(cloud.times_s, return_inverse=True)
    attitudes = attitude.between(cloud.stamp_s + np.append(times, 0.0))
    own, ends, origins, kept = _level(
        np.array(cloud.points, dtype=np.float32, order="C"),  # whatever the driver's memory is like
        inverse.astype(np.int64),
        attitudes,
        cloud.T_base_sensor.astype(np.float64),
        base_height_m,
        reach_m,
    )
    return LevelCloud(cloud.stamp_s, cloud.times_s[kept].astype(np.float64), own, ends, origins)


@njit(cache=True)
def _level(
    points: Singles,
    moments: NDArray[np.int64],
    attitudes: Floats,
    sensor: Floats,
    base_height: float,
    reach: float,
) -> tuple[Singles, Singles, Singles, NDArray[np.int64]]:
    """``attitudes[moments[i]]`` is that of point i; the last one is that at the stamp."""
    count = points.shape[0]
    own, ends = np.empty((count, 3), np.float32), np.empty((count, 3), np.float32)
    origins, kept = np.empty((count, 3), np.float32), np.empty(count, np.int64)
    final = attitudes[attitudes.shape[0] - 1]
    length = np.hypot(final[0, 0], final[1, 0])
    cos_f, sin_f = final[0, 0] / length, final[1, 0] / length
    n = 0
    base, mount = np.empty(3), np.empty(3)
    for i in range(count):
        x, y, z = float(points[i, 0]), float(points[i, 1]), float(points[i, 2])
        square = x * x + y * y + z * z
        if not square <= reach * reach:  # NaN is dropped too
            continue
        R = attitudes[moments[i]]
        for k in range(3):
            base[k] = sensor[k, 0] * x + sensor[k, 1] * y + sensor[k, 2] * z + sensor[k, 3]
            mount[k] = sensor[k, 3]
        px, py, pz = _apply(R, base)
        mx, my, mz = _apply(R, mount)
        length = np.hypot(R[0, 0], R[1, 0])
        cos, sin = R[0, 0] / length, R[1, 0] / length
        own[n, 0], own[n, 1], own[n, 2] = cos * px + sin * py, -sin * px + cos * py, pz + base_height
        ends[n, 0], ends[n, 1], ends[n, 2] = (
            cos_f * px + sin_f * py,
            -sin_f * px + cos_f * py,
            pz + base_height,
        )
        origins[n, 0] = cos_f * mx + sin_f * my
        origins[n, 1] = -sin_f * mx + cos_f * my
        origins[n, 2] = mz + base_height
        kept[n] = i
        n += 1
    return own[:n], ends[:n], origins[:n], kept[:n]


@njit(cache=True)
def _apply(R: Floats, v: Floats) -> tuple[float, float, float]:
    return (
        R[0, 0] * v[0] + R[0, 1] * v[1] + R[0, 2] * v[2],
        R[1, 0] * v[0] + R[1, 1] * v[1] + R[1, 2] * v[2],
        R[2, 0] * v[0] + R[2, 1] * v[1] + R[2, 2] * v[2],
    )
