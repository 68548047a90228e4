"""Our own recordings: the scans of one robot."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from explore_bt.errors import LogCutOff, LogError
from explore_bt.recording import RecordedMessage, read_recording
from explore_bt.types import Measurement, Pose2, Scan2D
from explore_bt_drivers.replay.log import MeasurementLog

__all__ = ["RecordingLog"]

_RANGE_MIN_M = 0.02


class RecordingLog(MeasurementLog):
    """``recording.mcap`` of a mission: the scans as they were recorded, to the centimetre.

    A recording holds neither IMU nor wheel odometry, and by default two scans a second (the recorder's
    option ``scan_period``).

    Args:
        path: the file.
        robot: whose scans; None: the first robot's.
        range_max_m: the lidar's range; None: as recorded.
    """

    def __init__(self, path: Path, robot: str | None = None, range_max_m: float | None = None) -> None:
        super().__init__(path)
        self._robot = robot
        self._range_max_m = range_max_m
        self._done, self._span_s = 0.0, 0.0

    @property
    def progress(self) -> float:
        """Share of the recorded time."""
        return self._done

    def _read(self) -> Iterator[Measurement]:
        recording = read_recording(self.path)
        robots = recording.robots
        robot = self._robot or next(iter(robots), "")
        if robot not in robots:
            known = ", ".join(robots) or "none"
            raise LogError(f'{self.path}: there is no robot "{robot}" in it; robots are {known}')
        scan_topic, pose_topic = f"/{robot}/scan", f"/{robot}/pose"
        estimate = Pose2.identity()
        scans = 0
        for message in recording.messages():
            self._done = min(message.stamp_s / max(recording.duration_s, 1e-9), 1.0)
            if message.topic == scan_topic:
                scans += 1
                yield self._scan(message, scans, estimate)
            elif message.topic == pose_topic:
                estimate = self._understood(message, scans, _pose)
            else:
                self.passed_over[message.topic] += 1
        if recording.damage:
            raise LogCutOff(f"{self.path}: {recording.damage}")
        if not scans:
            raise LogError(f"{self.path}: not one scan of robot {robot} in it")

    def _scan(self, message: RecordedMessage, index: int, estimate: Pose2) -> Scan2D:
        return self._understood(message, index, lambda value: _scan(value, estimate, self._range_max_m))

    def _understood(self, message: RecordedMessage, index: int, read: Any) -> Any:
        try:
            with np.errstate(all="ignore"):  # what overflows in a damaged message is infinite afterwards
                return read(message.value)
        except (KeyError, TypeError, ValueError, OverflowError) as fault:
            raise LogError(
                f"{self.path}: message on {message.topic} at {message.stamp_s:.3f} s (scan {index}) is not "
                f"as this version of explore-bt writes it ({type(fault).__name__}: {fault})"
            ) from None


def _scan(value: Mapping[str, Any], estimate: Pose2, range_max_m: float | None) -> Scan2D:
    """A ``foxglove.LaserScan`` of ours; its pose is the sensor's in ``map``."""
    written = value["ranges"]
    ranges = np.array([math.nan if each is None else each for each in written], dtype=np.float64)
    stamp = value["timestamp"]
    reach_m = float(range_max_m or value["range_max"])
    ranges[ranges >= reach_m] = math.inf
    ranges[ranges <= 0.0] = math.nan
    return Scan2D(
        stamp["sec"] + 1e-9 * stamp["nsec"],
        np.linspace(float(value["start_angle"]), float(value["end_angle"]), len(ranges)),
        ranges.astype(np.float32),
        np.linspace(-float(value["sweep_s"]), 0.0, len(ranges)),
        float(value["range_min"]),
        reach_m,
        T_base_sensor=estimate.between(_pose(value)),
    )


def _pose(value: Mapping[str, Any]) -> Pose2:
    position, turn = value["pose"]["position"], value["pose"]["orientation"]
    return Pose2(
        float(position["x"]), float(position["y"]), 2.0 * math.atan2(float(turn["z"]), float(turn["w"]))
    )
