"""Our own recordings: what one robot's SLAM was given."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from explore_bt.errors import LogCutOff, LogError
from explore_bt.recording import RecordedMessage, decode_measurements, decode_pose, read_recording
from explore_bt.types import Measurement, PointCloud, Pose2, Scan2D
from explore_bt_drivers.replay.log import MeasurementLog

__all__ = ["RecordingLog"]


class RecordingLog(MeasurementLog):
    """``recording.mcap`` of a mission: scans, IMU and wheel odometry in the order in which SLAM heard them.

    Clouds are in it if the recorder was told to (its option ``clouds``), images never.

    Args:
        path: the file.
        robot: whose measurements; None: the first robot's.
        range_max_m: the lidar's range; None: as recorded.
    """

    def __init__(self, path: Path, robot: str | None = None, range_max_m: float | None = None) -> None:
        super().__init__(path)
        self._robot = robot
        self._range_max_m = range_max_m
        self._done = 0.0

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
        self.start = next(map(_pose, recording.messages(f"/{robot}/pose")), None)
        radius_m = recording.info.get("footprint_radius_m", {}).get(robot)
        self.radius_m = radius_m if isinstance(radius_m, int | float) else None
        scans = 0
        for index, message in enumerate(recording.messages(f"/{robot}/measured"), 1):
            self._done = min(message.stamp_s / max(recording.duration_s, 1e-9), 1.0)
            for measurement in self._measurements(message, index):
                scans += isinstance(measurement, Scan2D | PointCloud)
                yield measurement
        if recording.damage:
            raise LogCutOff(f"{self.path}: {recording.damage}")
        if not scans:
            raise LogError(
                f"{self.path}: not one scan of robot {robot} in it; of a 3D lidar the recorder keeps "
                "nothing unless its option clouds says so"
            )

    def _measurements(self, message: RecordedMessage, index: int) -> Sequence[Measurement]:
        try:
            with np.errstate(all="ignore"):  # what overflows in a damaged message is infinite afterwards
                return [self._cut(each) for each in decode_measurements(message.value)]
        except (KeyError, TypeError, ValueError, IndexError, OverflowError, MemoryError) as fault:
            raise LogError(
                f"{self.path}: message {index} on {message.topic}, at {message.stamp_s:.3f} s, is not as "
                f"this version of explore-bt writes it ({type(fault).__name__}: {fault})"
            ) from None

    def _cut(self, measurement: Measurement) -> Measurement:
        if self._range_max_m is None or not isinstance(measurement, Scan2D):
            return measurement
        seen = measurement.ranges_m >= self._range_max_m
        ranges = np.where(seen, np.float32(np.inf), measurement.ranges_m)
        return replace(measurement, ranges_m=ranges, range_max_m=self._range_max_m)


def _pose(message: RecordedMessage) -> Pose2 | None:
    """Of a ``foxglove.PoseInFrame``; None where nothing was known."""
    try:
        pose = decode_pose(message.value["pose"])
    except (KeyError, TypeError, ValueError):
        return None
    return pose if math.isfinite(pose.x) else None
