"""What SLAM has heard, packed: one message for a second of measurements, in their order.

JSON whose arrays are bytes in base64: ten minutes hold eighty thousand measurements; none of them may cost
what a line of text costs.
"""

from __future__ import annotations

import base64
import json
import math
from collections.abc import Sequence
from functools import lru_cache
from itertools import chain

import numpy as np
from numpy.typing import NDArray

from explore_bt.recording.foxglove import time_json
from explore_bt.types import Imu, Measurement, PointCloud, Scan2D, WheelOdometry

__all__ = ["measurements_message"]

_STEP_M = 5e-4
_MOST = 65533
_INVALID, _NOTHING = 65534, 65535
_LETTERS: dict[type, str] = {Imu: "I", WheelOdometry: "O", Scan2D: "S", PointCloud: "C"}
_CLOUD_STEP_M = 1e-3
_EVEN = 1e-9


def measurements_message(time_ns: int, measurements: Sequence[Measurement]) -> str:
    """``explore_bt.Measurements``; see docs/recording.md for its members. Images are left out.

    Ranges are rounded to 0.5 mm and points to 1 mm (coarser where a lidar sees farther than 32 m), gyroscope
    and accelerometer to single precision; stamps, odometry and mountings are exact.
    """
    imus = [each for each in measurements if isinstance(each, Imu)]
    odometries = [each for each in measurements if isinstance(each, WheelOdometry)]
    scans = [each for each in measurements if isinstance(each, Scan2D)]
    clouds = [each for each in measurements if isinstance(each, PointCloud)]
    order = [_LETTERS[type(each)] for each in measurements if type(each) in _LETTERS]
    readings = chain.from_iterable(
        vector for imu in imus for vector in (imu.angular_velocity_rps, imu.linear_acceleration_mps2)
    )
    poses = [(each.T_odom_base, each.stamp_s) for each in odometries]
    arrays = {
        "imu_stamps": np.array([imu.stamp_s for imu in imus], dtype="<f8"),
        "imu": np.fromiter(readings, dtype="<f4", count=6 * len(imus)),
        "odometry": np.array([(stamp_s, p.x, p.y, p.yaw_rad) for p, stamp_s in poses], dtype="<f8"),
        "scan_stamps": np.array([scan.stamp_s for scan in scans], dtype="<f8"),
    }
    # not by the encoder: it would look for quotes in every byte of them
    texts = ",".join(f'"{name}":"{_packed(array)}"' for name, array in arrays.items())
    clouds_json = json.dumps([_cloud(cloud) for cloud in clouds])
    return (
        f'{{"timestamp":{time_json(time_ns)},"order":"{"".join(order)}",{texts},{_scans(scans)},'
        f'"clouds":{clouds_json}}}'
    )


def _scans(scans: Sequence[Scan2D]) -> str:
    """The scans, and each lidar's geometry once: scans that share it are told by its number."""
    lidars: list[Scan2D] = []
    of_lidar = []
    for scan in scans:
        number = next((k for k, lidar in enumerate(lidars) if _same_lidar(lidar, scan)), len(lidars))
        if number == len(lidars):
            lidars.append(scan)
        of_lidar.append(number)
    ranges = np.concatenate([scan.ranges_m for scan in scans] or [np.zeros(0, np.float32)]).astype(np.float64)
    finite = np.isfinite(ranges) & (ranges >= 0.0)
    step_m = max(_STEP_M, float(ranges.max(initial=0.0, where=finite)) / _MOST)
    steps = np.rint(np.where(finite, ranges, 0.0) / step_m).astype("<u2")
    steps[~finite] = _INVALID
    steps[np.isposinf(ranges)] = _NOTHING
    figures = json.dumps([_lidar(lidar) for lidar in lidars])
    return (
        f'"lidars":{figures},"scan_lidars":{of_lidar},"range_step_m":{step_m!r},"ranges":"{_packed(steps)}"'
    )


def _same_lidar(one: Scan2D, other: Scan2D) -> bool:
    return (
        (one.frame, one.T_base_sensor, one.range_min_m, one.range_max_m)
        == (other.frame, other.T_base_sensor, other.range_min_m, other.range_max_m)
        and _same(one.angles_rad, other.angles_rad)
        and _same(one.times_s, other.times_s)
    )


def _same(one: NDArray[np.float64], other: NDArray[np.float64]) -> bool:
    return one is other or np.array_equal(one, other)


def _lidar(scan: Scan2D) -> dict[str, object]:
    mounting = scan.T_base_sensor
    return {
        "frame": scan.frame,
        "mounting": [mounting.x, mounting.y, mounting.yaw_rad],
        "range_min": _figure(scan.range_min_m),
        "range_max": _figure(scan.range_max_m),
        "angles": _series(scan.angles_rad.tobytes()),
        "times": _series(scan.times_s.tobytes()),
    }


def _cloud(cloud: PointCloud) -> dict[str, object]:
    finite = np.asarray(np.isfinite(cloud.points).all(axis=1))
    points = np.where(finite[:, None], cloud.points, 0.0).astype(np.float64)
    step_m = max(_CLOUD_STEP_M, float(np.abs(points).max(initial=0.0)) / 32767.0)
    steps = np.rint(points / step_m).astype("<i2")
    steps[~finite] = -32768
    return {
        "stamp": cloud.stamp_s,
        "frame": cloud.frame,
        "mounting": cloud.T_base_sensor.ravel().tolist(),
        "range_max": _figure(cloud.range_max_m),
        "point_step_m": step_m,
        "points": _packed(steps),
        "times": _packed(cloud.times_s.astype("<f4")),
    }


@lru_cache(maxsize=16)
def _series(raw: bytes) -> object:
    """First, last and count of evenly spaced float64 values, else their bytes."""
    values = np.frombuffer(raw)
    if len(values) and np.isfinite(values).all():
        even = np.linspace(values[0], values[-1], len(values))
        if np.abs(even - values).max() <= _EVEN:
            return [float(values[0]), float(values[-1]), len(values)]
    return _packed(values.astype("<f8"))


def _packed(array: NDArray[np.generic]) -> str:
    """Little-endian bytes in base64: first the lowest byte of every number, then the next of every number.

    Side by side, bytes that are all noise do not spoil the compression of those that hardly change.
    """
    planes = np.frombuffer(array.tobytes(), dtype=np.uint8).reshape(-1, array.dtype.itemsize).T
    return base64.b64encode(planes.tobytes()).decode()


def _figure(value: float) -> float | None:
    return value if math.isfinite(value) else None
