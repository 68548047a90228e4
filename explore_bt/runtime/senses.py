"""What the driver measured on its way to SLAM, and what the newest scan shows to those who drive."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from explore_bt.interfaces import Slam, Surroundings
from explore_bt.runtime.fault_log import FaultLog
from explore_bt.runtime.lookout import Lookout
from explore_bt.runtime.people import People
from explore_bt.runtime.steadied import steadied
from explore_bt.runtime.team_mate import without_mates
from explore_bt.runtime.upright import Upright
from explore_bt.types import (
    BodyShape,
    Estimate,
    Health,
    Mate,
    Measurement,
    MovingObstacle,
    Pose2,
    Scan2D,
    Twist2,
)

__all__ = ["Senses"]


class _Drives(Protocol):
    """The part of the pilot that knows what was commanded."""

    def has_jumped(self, estimate: Estimate) -> bool:
        """Whether the pose is elsewhere than commands led to."""

    def carry(self, estimate: Estimate, time_s: float) -> Estimate:
        """The estimate carried forward, the body's lag counted."""

    def twist_at(self, time_s: float) -> Twist2:
        """What the body drove at a time of the last seconds."""


class Senses:
    """One robot's.

    Attributes:
        scan_pose: where the robot was at the stamp of ``scan``, ``map`` frame; None before the first.
        scan_twist: how it moved then.
        moving: what moves around, as that scan tells.
        measured: what SLAM was given since somebody last emptied this.
        mates: team mates whose word is fresh: SLAM and whoever looks for people are not shown them.
    """

    def __init__(self, slam: Slam, upright: Upright, faults: FaultLog) -> None:
        self._slam = slam
        self._upright = upright
        self._faults = faults
        self._lookout = Lookout()
        self._people = People()
        self._slam_fault = ""
        self.scan_pose: Pose2 | None = None
        self.scan_twist = Twist2()
        self.moving: tuple[MovingObstacle, ...] = ()
        self.measured: list[Measurement] = []
        self.mates: tuple[Mate, ...] = ()

    def setup(self, shape: BodyShape) -> None:
        """Know what a 3D lidar's returns are to be judged by; before the first measurement."""
        self._lookout = Lookout(shape)

    @property
    def scan(self) -> Scan2D | None:
        """The newest scan to drive by, None before the first."""
        return self._lookout.scan

    @property
    def range_m(self) -> float:
        """How far the lidar sees."""
        return self._lookout.range_m

    def estimate(self) -> Estimate:
        """SLAM's newest pose, ``lost`` if the plugin itself broke down."""
        estimate = self._slam.estimate()
        if self._slam_fault:
            return replace(estimate, health=Health.LOST, reason=self._slam_fault)
        return estimate

    def take(self, measurement: Measurement, pilot: _Drives) -> bool:
        """Give one to SLAM; whether it was given. ``pilot`` knows where the robot is meanwhile."""
        self._lookout.hear(measurement, pilot.twist_at)
        if self._slam_fault or not self._upright.passes():
            return False
        if isinstance(measurement, Scan2D):
            measurement = self._strangers(measurement, pilot)
        self.measured.append(measurement)
        try:
            self._slam.update(measurement)
        except Exception as error:  # a SLAM that raises is lost: the gate brakes, the reason is recorded
            self._slam_fault = f"slam {self._slam.name} failed: {error!r}"
            self._faults.note(f"slam {self._slam.name}", error)
        return True

    def begin(self) -> None:
        """What was taken so far is another process's: drive by nothing before the next scan."""
        self.measured, self.scan_pose = [], None
        self._lookout.forget()

    def drain(self) -> Sequence[Measurement]:
        """What SLAM was given since the last call."""
        measured, self.measured = self.measured, []
        return measured

    def look(self, scan: Scan2D, pilot: _Drives) -> tuple[Surroundings, Estimate]:
        """What the newest scan shows, and the estimate at its stamp."""
        estimate = self._estimate_of_scan(scan, pilot)
        twist = pilot.twist_at(scan.stamp_s + float(scan.times_s.mean()))
        self.scan_pose, self.scan_twist = estimate.T_map_base, twist
        if pilot.has_jumped(estimate):
            self._people.forget()
        strangers, points = self._strangers(scan, pilot), self.seen_points(pilot)
        around = self._people.around(strangers, estimate.T_map_base, twist, points, self._slam.grid())
        self.moving = around.moving
        return around, estimate

    def seen_points(self, pilot: _Drives) -> NDArray[np.float64]:
        """(N, 2) metres, ``map`` frame: the newest scan's returns, less noisy close by."""
        if self.scan is None:
            return np.empty((0, 2))
        pose = self._estimate_of_scan(self.scan, pilot).T_map_base
        return np.ascontiguousarray(pose.apply(steadied(self.scan).points()))

    def _strangers(self, scan: Scan2D, pilot: _Drives) -> Scan2D:
        """The scan without those of the team."""
        if not self.mates:
            return scan
        return without_mates(scan, self._estimate_of_scan(scan, pilot).T_map_base, self.mates)

    def _estimate_of_scan(self, scan: Scan2D, pilot: _Drives) -> Estimate:
        """The newest, carried forward to the scan where SLAM lags behind."""
        estimate = self._slam.estimate()
        is_late = estimate.stamp_s < scan.stamp_s
        return pilot.carry(estimate, scan.stamp_s) if is_late else estimate
