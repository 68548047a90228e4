"""Logs of the CARMEN toolkit: ``FLASER``, ``ROBOTLASER1`` and ``ODOM`` lines.

The format is the one of CARMEN's ``logger`` (http://carmen.sourceforge.net/doc/binary__loggerplayback.html).
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from itertools import islice
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from explore_bt.errors import LogError
from explore_bt.types import Measurement, Pose2, Scan2D, WheelOdometry
from explore_bt_drivers.replay.carmen_line import CarmenLine
from explore_bt_drivers.replay.log import MeasurementLog
from explore_bt_drivers.replay.text_lines import TextLines

__all__ = ["CarmenLog"]

_READ = ("FLASER", "ROBOTLASER1", "ODOM")
_RANGE_MIN_M = 0.02
_SICK_LIMITS_M = (8.18, 16.37, 32.75)
"""What a SICK LMS reports from there on are its codes for "no return": 8.183 to 8.191 m in its 8 m mode,
twice and four times that in the next ones."""
_LONGEST_M = 80.0
_CODES = 1.0015
_PROBED_LINES = 200
_STEADY_M = 0.001
_STEADY_RAD = 0.001
_LARGEST_ROBOT_M = 1.0
_NAME = re.compile(r"[A-Z][A-Z0-9_-]*")


class CarmenLog(MeasurementLog):
    """A CARMEN log: plain, ``.gz`` or ``.bz2``.

    A laser line is two measurements with one stamp: the odometry it carries, then the scan. ``ODOM`` lines
    repeat that odometry unsynchronised, and are played only on demand.

    A ``FLASER`` line does not say where the laser looks nor how far: beam i points to
    ``-fov / 2 + i · step``, counter-clockwise, with ``step`` = fov over the number of beams (one less where
    it is odd, as in 181 or 361). Its first pose is the laser's in some logs and one corrected by a SLAM in
    others: it places the laser on the robot if it stays where it is relative to the odometry's over the first
    200 laser lines, else the laser is taken to sit in ``base_link``. A ``ROBOTLASER1`` line says all of it.

    Args:
        path: the file.
        fov_rad: field of view of ``FLASER`` lines.
        range_max_m: from there on a range means "no return"; None: the smallest limit of a SICK LMS that no
            reading of the first 200 laser lines exceeds (8.18, 16.37, 32.75 or 80 m).
        odom_lines: whether ``ODOM`` lines are played too.
    """

    def __init__(
        self,
        path: Path,
        fov_rad: float = math.pi,
        range_max_m: float | None = None,
        odom_lines: bool = False,
    ) -> None:
        super().__init__(path)
        self._lines = TextLines(path)
        self._fov_rad = fov_rad
        self._given_max_m = range_max_m
        self._range_max_m = _LONGEST_M
        self._mount = Pose2.identity()
        self._odom_lines = odom_lines
        self._angles: dict[int, NDArray[np.float64]] = {}

    @property
    def progress(self) -> float:
        """Share of the file's bytes."""
        return self._lines.progress

    def _read(self) -> Iterator[Measurement]:
        probed_m, self._mount = _probe(self.path)
        self._range_max_m = self._given_max_m or probed_m
        known = 0
        for number, text in self._lines:
            line = CarmenLine(self.path, number, text)
            if line.name in _READ:
                known += 1
                yield from self._measurements(line)
            else:
                self._pass_over(line)
        if not known:
            raise LogError(
                f"{self.path}: not one {', '.join(_READ[:-1])} or {_READ[-1]} line in it; "
                "expected a CARMEN log"
            )

    def _measurements(self, line: CarmenLine) -> Iterator[Measurement]:
        if line.name == "FLASER":
            yield from self._flaser(line)
        elif line.name == "ROBOTLASER1":
            yield from _robotlaser(line)
        elif self._odom_lines:
            yield _odometry(line)
        else:
            _odometry(line)
            self.passed_over["ODOM"] += 1

    def _flaser(self, line: CarmenLine) -> Iterator[Measurement]:
        count = line.count("the number of readings")
        ranges = line.ranges(count)
        line.pose("the laser's")
        odometry = line.pose("the odometry's")
        stamp_s = line.number("the time stamp")
        line.end(2, "a host name and the logger's time stamp")
        yield WheelOdometry(stamp_s, odometry)
        yield _scan(stamp_s, self._directions(count), ranges, self._range_max_m, self._mount)

    def _directions(self, count: int) -> NDArray[np.float64]:
        """(count,) float64 directions of a ``FLASER`` line's beams, shared by all scans of that size."""
        if count not in self._angles:
            steps = max(count - count % 2, 1)
            angles = _evenly(-0.5 * self._fov_rad, self._fov_rad / steps, count)
            angles.setflags(write=False)
            self._angles[count] = angles
        return self._angles[count]

    def _pass_over(self, line: CarmenLine) -> None:
        if line.name in ("", "#"):
            return
        if not line.is_ended and any(name.startswith(line.name) for name in _READ):
            raise line.fault("", cut=True)
        if not _NAME.fullmatch(line.name):
            raise line.fault("expected the name of a CARMEN message, in capitals")
        self.passed_over[line.name] += 1


def _robotlaser(line: CarmenLine) -> Iterator[Measurement]:
    line.number("the laser's type")
    start_rad = line.number("the start angle")
    fov_rad = line.number("the field of view")
    step_rad = line.number("the angular resolution")
    range_max_m = line.number("the maximum range")
    if range_max_m <= 0.0:
        raise line.fault(f"the maximum range is {range_max_m:g}; expected metres above 0")
    line.number("the accuracy")
    line.number("the remission mode")
    count = line.count("the number of readings")
    ranges = line.ranges(count)
    line.ranges(line.count("the number of remissions"))
    laser, robot = line.pose("the laser's"), line.pose("the robot's")
    for what in ("tv", "rv", "forward safety distance", "side safety distance", "turn axis"):
        line.number(f"the {what}")
    stamp_s = line.number("the time stamp")
    line.end(2, "a host name and the logger's time stamp")
    step_rad = step_rad or fov_rad / max(count - 1, 1)
    angles = _evenly(start_rad, step_rad, count)
    yield WheelOdometry(stamp_s, robot)
    yield _scan(stamp_s, angles, ranges, range_max_m, robot.between(laser))


def _odometry(line: CarmenLine) -> WheelOdometry:
    pose = line.pose("the odometry's")
    for what in ("tv", "rv", "accel"):
        line.number(what)
    stamp_s = line.number("the time stamp")
    line.end(2, "a host name and the logger's time stamp")
    return WheelOdometry(stamp_s, pose)


def _evenly(first_rad: float, step_rad: float, count: int) -> NDArray[np.float64]:
    return first_rad + step_rad * np.arange(count, dtype=np.float64)


def _scan(
    stamp_s: float,
    angles_rad: NDArray[np.float64],
    ranges_m: NDArray[np.float64],
    range_max_m: float,
    T_base_sensor: Pose2,
) -> Scan2D:
    ranges_m[ranges_m >= range_max_m] = math.inf
    return Scan2D(
        stamp_s,
        angles_rad,
        ranges_m.astype(np.float32),
        np.zeros(len(ranges_m)),
        _RANGE_MIN_M,
        range_max_m,
        T_base_sensor=T_base_sensor,
    )


def _probe(path: Path) -> tuple[float, Pose2]:
    """From the first laser lines: where "no return" begins, and where the laser sits on the robot."""
    lines = (CarmenLine(path, number, text) for number, text in TextLines(path))
    longest_m = 0.0
    mounts: list[Pose2] = []
    try:
        for line in islice((line for line in lines if line.name == "FLASER"), _PROBED_LINES):
            ranges = line.ranges(line.count("the number of readings"))
            longest_m = max(longest_m, float(np.nanmax(ranges, initial=0.0)))
            laser, robot = line.pose("the laser's"), line.pose("the odometry's")
            mounts.append(robot.between(laser))
    except LogError:
        pass  # the reading proper comes to it too, and tells
    limit_m = next((limit for limit in _SICK_LIMITS_M if longest_m <= limit * _CODES), _LONGEST_M)
    return limit_m, _steady(mounts)


def _steady(mounts: list[Pose2]) -> Pose2:
    """The place that all agree on, if it is on a robot at all; else the identity."""
    if not mounts:
        return Pose2.identity()
    places = np.array([mount.as_array() for mount in mounts])
    middle = np.median(places, axis=0)
    off = np.abs(places - middle).max(axis=0)
    is_steady = bool(np.hypot(off[0], off[1]) <= _STEADY_M and off[2] <= _STEADY_RAD)
    is_on_robot = bool(np.hypot(middle[0], middle[1]) <= _LARGEST_ROBOT_M)
    if len(mounts) < _PROBED_LINES or not (is_steady and is_on_robot):
        return Pose2.identity()
    return Pose2(*np.round(middle, 4).tolist())
