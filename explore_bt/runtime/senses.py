"""What the driver measured on its way to SLAM, and what the newest scan shows to those who drive."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from explore_bt.interfaces import Slam, Surroundings
from explore_bt.runtime.fault_log import FaultLog
from explore_bt.runtime.people import People
from explore_bt.runtime.steadied import steadied
from explore_bt.runtime.team_mate import without_mates
from explore_bt.types import (
    Estimate,
    Health,
    Mate,
    Measurement,
    MotionState,
    MovingObstacle,
    Pose2,
    Scan2D,
    Twist2,
)

__all__ = ["Senses"]


class _Drives(Protocol):
    """The part of the pilot that knows what was commanded."""

    motion: MotionState

    def has_jumped(self, estimate: Estimate) -> bool:
        """Whether the pose is elsewhere than commands led to."""

    def predict(self, estimate: Estimate, now_s: float) -> Estimate:
        """The estimate carried forward."""


class Senses:
    """One robot's.

    Attributes:
        scan: the newest, None before the first.
        scan_pose: where the robot was at its stamp, ``map`` frame; None before the first.
        scan_twist: how it moved then.
        moving: what moves around, as that scan tells.
        measured: what SLAM was given since somebody last emptied this.
        mates: team mates whose word is fresh: SLAM and whoever looks for people are not shown them.
    """

    def __init__(self, slam: Slam, faults: FaultLog) -> None:
        self._slam = slam
        self._faults = faults
        self._people = People()
        self._slam_fault = ""
        self.scan: Scan2D | None = None
        self.scan_pose: Pose2 | None = None
        self.scan_twist = Twist2()
        self.moving: tuple[MovingObstacle, ...] = ()
        self.measured: list[Measurement] = []
        self.mates: tuple[Mate, ...] = ()
        self._strangers: Scan2D | None = None

    def estimate(self) -> Estimate:
        """SLAM's newest pose, ``lost`` if the plugin itself broke down."""
        estimate = self._slam.estimate()
        if self._slam_fault:
            return replace(estimate, health=Health.LOST, reason=self._slam_fault)
        return estimate

    def take(self, measurement: Measurement, pilot: _Drives | None = None) -> bool:
        """Give one to SLAM; whether it was given. ``pilot`` knows where the robot is meanwhile."""
        if isinstance(measurement, Scan2D):
            self.scan = measurement
            if pilot is not None and self.mates:
                pose = pilot.predict(self._slam.estimate(), measurement.stamp_s).T_map_base
                measurement = without_mates(measurement, pose, self.mates)
            self._strangers = measurement
        if self._slam_fault:
            return False
        self.measured.append(measurement)
        try:
            self._slam.update(measurement)
        except Exception as error:  # a SLAM that raises is lost: the gate brakes, the reason is recorded
            self._slam_fault = f"slam {self._slam.name} failed: {error!r}"
            self._faults.note(f"slam {self._slam.name}", error)
        return True

    def begin(self) -> None:
        """What was taken so far is another process's: drive by nothing before the next scan."""
        self.measured, self.scan, self.scan_pose = [], None, None

    def drain(self) -> Sequence[Measurement]:
        """What SLAM was given since the last call."""
        measured, self.measured = self.measured, []
        return measured

    def look(self, pilot: _Drives) -> tuple[Surroundings, Estimate]:
        """What the newest scan shows, and the estimate at its stamp."""
        assert self.scan is not None  # asked for after a scan only
        assert self._strangers is not None  # taken with it
        estimate = self._estimate_of_scan(self.scan, pilot)
        self.scan_pose, self.scan_twist = estimate.T_map_base, pilot.motion.twist
        if pilot.has_jumped(estimate):
            self._people.forget()
        around = self._people.around(
            self._strangers,
            estimate.T_map_base,
            pilot.motion.twist,
            self.seen_points(pilot),
            self._slam.grid(),
        )
        self.moving = around.moving
        return around, estimate

    def seen_points(self, pilot: _Drives) -> NDArray[np.float64]:
        """(N, 2) metres, ``map`` frame: the newest scan's returns, less noisy close by."""
        if self.scan is None:
            return np.empty((0, 2))
        pose = self._estimate_of_scan(self.scan, pilot).T_map_base
        return np.ascontiguousarray(pose.apply(steadied(self.scan).points()))

    def _estimate_of_scan(self, scan: Scan2D, pilot: _Drives) -> Estimate:
        """The newest, carried forward to the scan where SLAM lags behind."""
        estimate = self._slam.estimate()
        is_late = estimate.stamp_s < scan.stamp_s
        return pilot.predict(estimate, scan.stamp_s) if is_late else estimate
