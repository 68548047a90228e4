"""A robot that is nothing but a map and a pose, for the leaves of a tree."""

from __future__ import annotations

import numpy as np

from explore_bt.exploration import scan_of_grid
from explore_bt.headless.grid_pilot import GridPilot
from explore_bt.interfaces import MapView, Planner
from explore_bt.types import Estimate, OccupancyGrid, Path, Pose2, Scan2D, Trajectory

__all__ = ["GridRobot"]

_TRACK_SPACING_M = 0.1


class GridRobot:
    """Implements ``RobotServices`` over what the caller of ``Explorer.decide`` gives.

    A report counts as a second of mission time: leaves that look again every second look at every report.
    """

    stop_requested = False

    def __init__(self, name: str, planner: Planner, footprint_radius_m: float, lidar_range_m: float) -> None:
        self.name = name
        self.footprint_radius_m = footprint_radius_m
        self.lidar_range_m = lidar_range_m
        self.distance_m = 0.0
        self.pilot = GridPilot()
        self._planner = planner
        self._reports = 0
        self._pose = self.home = Pose2.identity()
        self._view: MapView
        self._scan: Scan2D | None = None
        self._track: list[Pose2] = []

    def report(self, grid: OccupancyGrid, pose: Pose2) -> None:
        """The newest map and pose."""
        if self._reports == 0:
            self.home = pose
        else:
            self.distance_m += pose.distance_to(self._pose)
        self._reports += 1
        self._pose = pose
        if self._reports == 1 or grid is not self._view.grid:
            self._view = MapView(grid)
        self._scan = None
        self.pilot.report(pose)
        if not self._track or pose.distance_to(self._track[-1]) >= _TRACK_SPACING_M:
            self._track.append(pose)

    def now_s(self) -> float:
        """The number of reports so far."""
        return float(self._reports)

    def estimate(self) -> Estimate:
        """The pose that was reported, healthy."""
        return Estimate(self.now_s(), self._pose)

    def trajectory(self) -> Trajectory:
        """The poses reported, a tenth of a metre apart."""
        poses = np.array([(pose.x, pose.y, pose.yaw_rad) for pose in (*self._track, self._pose)])
        return Trajectory(np.arange(float(len(poses))), poses)

    def view(self) -> MapView:
        """The map that was reported."""
        return self._view

    def scan(self) -> Scan2D | None:
        """What a lidar would see in the map; unknown cells return like walls."""
        if self._scan is None:
            self._scan = scan_of_grid(self._view.grid, self._pose, self.lidar_range_m, stamp_s=self.now_s())
        return self._scan

    def plan(self, goal: Pose2) -> Path:
        """A path from the pose that was reported; raises a ``PlanningFailure``."""
        return self._planner.plan(self._view.grid, self._pose, goal, self.footprint_radius_m)

    def avoid(self, position: tuple[float, float]) -> None:
        """Nothing proves too tight for a robot that is not there."""

    def forget_avoided(self) -> int:
        """There are none."""
        return 0
