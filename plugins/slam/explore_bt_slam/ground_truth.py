"""The ``ground_truth`` plugin: the same map as ``kiss_gtsam``, drawn from the simulator's own pose."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from typing import ClassVar

import numpy as np

from explore_bt.errors import PluginError
from explore_bt.interfaces import API_VERSION, GroundTruth, PluginOptions, RobotContext, Slam
from explore_bt.types import (
    Estimate,
    GridWindow,
    Imu,
    Measurement,
    OccupancyGrid,
    Pose2,
    Scan2D,
    Trajectory,
)
from explore_bt_slam.frozen_state import FrozenState
from explore_bt_slam.health import HealthMonitor
from explore_bt_slam.inertial import InertialFilter
from explore_bt_slam.journal import Journal
from explore_bt_slam.mapper import Mapper
from explore_bt_slam.options import GroundTruthOptions
from explore_bt_slam.scan_check import fault_of
from explore_bt_slam.storage import read_arrays, unpack_sweeps
from explore_bt_slam.sweep import deskew

__all__ = ["GroundTruthSlam"]

_CERTAIN = np.diag([1e-6, 1e-6, 1e-6]) ** 2


class GroundTruthSlam(Slam):
    """For tests and baselines: what SLAM would do if it made no error."""

    name = "ground_truth"
    api_version = API_VERSION
    Options: ClassVar[type[PluginOptions]] = GroundTruthOptions

    def __init__(self, options: PluginOptions) -> None:
        super().__init__(options)
        self._settings = GroundTruthOptions.model_validate(options.model_dump())
        self._truth: GroundTruth | None = None
        self._is_waiting = False
        self._begin(0.25, Pose2.identity())

    def setup(self, context: RobotContext) -> None:
        """Take hold of the truth.

        Raises:
            PluginError: the driver is no simulator.
        """
        if context.truth is None:
            raise PluginError(
                "slam ground_truth needs a simulator, and this driver knows no truth; use kiss_gtsam"
            )
        self._begin(context.footprint_radius_m, context.start or context.truth.pose())
        self._truth = context.truth
        self._is_waiting = context.resumed is not None

    def update(self, measurement: Measurement) -> None:
        """Draw scans from where the robot is when they arrive; the gyroscope straightens them."""
        if self._is_waiting:
            return
        if isinstance(measurement, Imu):
            numbers = (measurement.stamp_s, *measurement.angular_velocity_rps)
            if np.isfinite([*numbers, *measurement.linear_acceleration_mps2]).all():
                self._filter.take_imu(measurement)
                self._health.passed(measurement.stamp_s)
        elif isinstance(measurement, Scan2D):
            begun = time.perf_counter()
            self._take_scan(measurement)
            self._journal.took(time.perf_counter() - begun)

    def estimate(self) -> Estimate:
        """The true pose at the last scan."""
        health, reason = self._health.state
        stamp_s = max(self._scan_s, 0.0)
        return Estimate(stamp_s, self._pose, _CERTAIN.copy(), self._mapper.revision, health, reason)

    def grid(self) -> OccupancyGrid:
        """The map; copied only when asked for and changed."""
        return self._mapper.grid()

    def changed_since(self, revision: int) -> GridWindow | None:
        """Window of cells that may differ from that revision."""
        return self._mapper.changed_since(revision)

    def forget_near(self, position: tuple[float, float], radius_m: float) -> bool:
        """Until the next sweep that sees them."""
        return self._mapper.forget_near(position, radius_m)

    def trajectory(self) -> Trajectory:
        """The true way, one pose per scan."""
        return self._journal.trajectory(self._origin)

    def figures(self) -> Mapping[str, float]:
        """``scans``, ``ms_per_scan_median``, ``ms_per_scan_p99``; no graph, hence no closures."""
        return {**self._journal.figures(), "keyframes": 0.0, "loop_closures": 0.0}

    def save(self, folder: Path) -> None:
        """One file, ``slam.npz``: kept sweeps, grid, trajectory."""
        self._frozen().write(folder, self.name, self._settings.resolution)

    def begin_save(self, folder: Path, before: Path | None) -> Callable[[], None]:
        """``slam.npz``, and the sweeps apart, of which only the new ones are written."""
        return partial(self._frozen().write_quickly, folder, self.name, self._settings.resolution, before)

    def load(self, folder: Path) -> None:
        """Go on in a saved map, wherever the simulator has put the robot."""
        arrays = read_arrays(folder, self.name, self._settings.resolution)
        self._mapper.restore(arrays, unpack_sweeps(arrays), self._origin)
        self._journal.restore(
            arrays["journal_stamps"], arrays["journal_keyframes"], arrays["journal_relatives"]
        )

    def pick_up(self) -> None:
        """What was recorded before could not be drawn: nobody knows the truth of then."""
        self._is_waiting = False

    def _frozen(self) -> FrozenState:
        stamps, keyframes, relatives = self._journal.arrays()
        arrays = {
            **{name: array.copy() for name, array in self._mapper.arrays().items()},
            "journal_stamps": stamps,
            "journal_keyframes": keyframes,
            "journal_relatives": relatives,
        }
        return FrozenState((), tuple(self._mapper.kept), arrays)

    def _begin(self, body_radius_m: float, start: Pose2) -> None:
        self._filter = InertialFilter()
        self._mapper = Mapper(self._settings.resolution, body_radius_m)
        self._mapper.begin(Pose2.identity(), start)
        self._journal = Journal()
        self._health = HealthMonitor()
        self._origin = np.zeros((1, 3))  # the one "keyframe": the map's own origin, which never moves
        self._pose = start
        self._scan_s = -np.inf

    def _take_scan(self, scan: Scan2D) -> None:
        problem = fault_of(scan, self._scan_s)
        if problem or self._truth is None:
            self._health.bad(scan.stamp_s, problem or "setup was not called")
            return
        first, last, self._pose = np.isinf(self._scan_s), self._pose, self._truth.pose()
        self._scan_s = scan.stamp_s
        self._filter.advance_to(scan.stamp_s)
        trail = self._filter.trail
        if not first:
            trail = trail.corrected_to(last.between(self._pose))
        self._filter.correct(trail.motion, _CERTAIN)
        self._mapper.see(deskew(scan, trail, self._settings.max_range), 0, Pose2.identity(), self._pose)
        self._health.good(scan.stamp_s)
        self._journal.note(scan.stamp_s, 0, self._pose)
