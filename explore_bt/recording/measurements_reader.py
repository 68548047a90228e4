"""Unpacks what ``measurements_message`` has packed."""

from __future__ import annotations

import base64
import math
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from explore_bt.types import Imu, Measurement, PointCloud, Pose2, Scan2D, WheelOdometry

__all__ = ["decode_measurements"]

_INVALID, _NOTHING = 65534, 65535


def decode_measurements(message: Mapping[str, Any]) -> list[Measurement]:
    """The measurements of an ``explore_bt.Measurements`` message, in the order SLAM heard them.

    Raises:
        KeyError, TypeError, ValueError, IndexError: the message is not as this version writes it.
    """
    sources: dict[str, Iterator[Measurement]] = {
        "I": _imus(message),
        "O": _odometries(message),
        "S": _scans(message),
        "C": (_cloud(each) for each in message["clouds"]),
    }
    found = []
    for place, letter in enumerate(message["order"]):
        measurement = next(sources[letter], None)
        if measurement is None:
            raise ValueError(f"order tells of more {letter} than there are, at {place}")
        found.append(measurement)
    return found


def _imus(message: Mapping[str, Any]) -> Iterator[Imu]:
    stamps = _unpacked(message["imu_stamps"], "<f8")
    rows = _unpacked(message["imu"], "<f4").astype(np.float64).reshape(-1, 6)
    for stamp_s, row in zip(stamps.tolist(), rows.tolist(), strict=True):
        yield Imu(stamp_s, (row[0], row[1], row[2]), (row[3], row[4], row[5]))


def _odometries(message: Mapping[str, Any]) -> Iterator[WheelOdometry]:
    for stamp_s, x, y, yaw_rad in _unpacked(message["odometry"], "<f8").reshape(-1, 4).tolist():
        yield WheelOdometry(stamp_s, Pose2(x, y, yaw_rad))


def _scans(message: Mapping[str, Any]) -> Iterator[Scan2D]:
    lidars = [_Lidar(each) for each in message["lidars"]]
    steps = _unpacked(message["ranges"], "<u2")
    ranges = (steps * float(message["range_step_m"])).astype(np.float32)
    ranges[steps == _INVALID] = np.nan
    ranges[steps == _NOTHING] = np.inf
    begin = 0
    stamps = _unpacked(message["scan_stamps"], "<f8").tolist()
    for stamp_s, number in zip(stamps, message["scan_lidars"], strict=True):
        lidar = lidars[number]
        end = begin + len(lidar.angles_rad)
        if end > len(ranges):
            raise ValueError(f"{len(ranges)} ranges; expected {end} or more")
        yield lidar.scan(stamp_s, ranges[begin:end])
        begin = end


class _Lidar:
    """What scans of one lidar have in common."""

    def __init__(self, value: Mapping[str, Any]) -> None:
        self.angles_rad = _series(value["angles"])
        self._times_s = _series(value["times"])
        if len(self._times_s) != len(self.angles_rad):
            raise ValueError(f"{len(self._times_s)} times for {len(self.angles_rad)} beams")
        self._range_min_m = _figure(value["range_min"])
        self._range_max_m = _figure(value["range_max"])
        self._frame = str(value["frame"])
        x, y, yaw_rad = value["mounting"]
        self._mounting = Pose2(float(x), float(y), float(yaw_rad))

    def scan(self, stamp_s: float, ranges_m: NDArray[np.float32]) -> Scan2D:
        """One of its scans."""
        return Scan2D(
            stamp_s,
            self.angles_rad,
            ranges_m,
            self._times_s,
            self._range_min_m,
            self._range_max_m,
            self._frame,
            self._mounting,
        )


def _cloud(value: Mapping[str, Any]) -> PointCloud:
    steps = _unpacked(value["points"], "<i2").reshape(-1, 3)
    points = (steps * float(value["point_step_m"])).astype(np.float32)
    points[steps[:, 0] == np.iinfo(np.int16).min] = np.nan
    times_s = _unpacked(value["times"], "<f4").astype(np.float64)
    if len(times_s) != len(points):
        raise ValueError(f"{len(times_s)} times for {len(points)} points")
    mounting = np.array(value["mounting"], dtype=np.float64).reshape(4, 4)
    range_max_m = _figure(value.get("range_max"))  # recordings up to now do not say
    return PointCloud(float(value["stamp"]), points, times_s, mounting, str(value["frame"]), range_max_m)


def _series(value: Any) -> NDArray[np.float64]:
    if isinstance(value, str):
        return _unpacked(value, "<f8").astype(np.float64)
    first, last, count = value
    if not 0 <= int(count) <= 1 << 20:
        raise ValueError(f"{count} beams; expected 0 to a million")
    return np.linspace(float(first), float(last), int(count))


def _unpacked(text: str, dtype: str) -> NDArray[Any]:
    """The numbers of which first the lowest bytes are written, then the next."""
    raw = base64.b64decode(text, validate=True)
    size = np.dtype(dtype).itemsize
    if len(raw) % size:
        raise ValueError(f"{len(raw)} bytes; expected a multiple of {size}")
    planes = np.frombuffer(raw, dtype=np.uint8).reshape(size, -1)
    return np.ascontiguousarray(planes.T).view(dtype).ravel()


def _figure(value: float | None) -> float:
    return math.inf if value is None else float(value)
