"""A robot that is nothing but a map and a pose, for the leaves of a tree."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from explore_bt.exploration import scan_of_grid
from explore_bt.fleet import Alone
from explore_bt.headless.grid_pilot import GridPilot
from explore_bt.interfaces import Allocator, MapMemory, MapView, Planner
from explore_bt.runtime.legs import plan_through
from explore_bt.runtime.tight_places import TightPlaces
from explore_bt.types import (
    Budget,
    Drawing,
    Estimate,
    MovingObstacle,
    OccupancyGrid,
    Path,
    Pose2,
    Scan2D,
    Trajectory,
)

__all__ = ["GridRobot"]

_TRACK_SPACING_M = 0.1
_GRAZE_M = 0.005
"""Between the centres of cells a path may come nearer to a corner than the cells' clearances say."""


class GridRobot:
    """Implements ``RobotServices`` over what the caller of ``Explorer.decide`` gives.

    A report counts as a second of mission time: leaves that look again every second look at every report.
    """

    stop_requested = False
    moving: tuple[MovingObstacle, ...] = ()
    least_margin_m = _GRAZE_M

    def __init__(
        self,
        name: str,
        planner: Planner,
        footprint_radius_m: float,
        lidar_range_m: float,
        allocator: Allocator | None = None,
    ) -> None:
        self.name = name
        self.footprint_radius_m = footprint_radius_m
        self.lidar_range_m = lidar_range_m
        self.distance_m = 0.0
        self.pilot = GridPilot()
        self._planner = planner
        self._reports = 0
        self._pose = self.home = Pose2.identity()
        self._grid: OccupancyGrid
        self._view: MapView | None = None
        self._map_memory = MapMemory()
        self._tight = TightPlaces()
        self.team = Alone(name, allocator)
        self._scan: Scan2D | None = None
        self._track: list[Pose2] = []

    def report(self, grid: OccupancyGrid, pose: Pose2) -> None:
        """The newest map and pose."""
        if self._reports == 0:
            self.home = pose
        else:
            self.distance_m += pose.distance_to(self._pose)
            passed = self.pilot.passed(self._pose, pose)
            self._track += [Pose2(x, y, yaw_rad) for x, y, yaw_rad in passed.tolist()]
        if self._reports == 0 or grid.cells is not self._grid.cells:
            self._grid = replace(grid, revision=self._reports)
        self._reports += 1
        self._pose = pose
        self._scan = None
        self.pilot.report(pose)
        if not self._track or pose.distance_to(self._track[-1]) >= _TRACK_SPACING_M:
            self._track.append(pose)

    def now_s(self) -> float:
        """The number of reports so far."""
        return float(self._reports)

    def budgets(self) -> tuple[Budget, ...]:
        """None: the caller keeps them."""
        return ()

    def estimate(self) -> Estimate:
        """The pose that was reported, healthy."""
        return Estimate(self.now_s(), self._pose)

    def trajectory(self) -> Trajectory:
        """The poses reported, and those of the path between them."""
        poses = np.array([(pose.x, pose.y, pose.yaw_rad) for pose in (*self._track, self._pose)])
        return Trajectory(np.arange(float(len(poses))), poses)

    def view(self) -> MapView:
        """The map that was reported, with the places that proved too tight closed."""
        grid = self._tight.mark(self._grid)
        if self._view is None or grid is not self._view.grid:
            self._view = MapView(grid, self._map_memory)
        return self._view

    def scan(self) -> Scan2D | None:
        """What a lidar would see in the map; unknown cells return like walls."""
        if self._scan is None:
            self._scan = scan_of_grid(self._grid, self._pose, self.lidar_range_m, stamp_s=self.now_s())
        return self._scan

    def plan(self, goal: Pose2, via: Sequence[tuple[float, float]] = ()) -> Path:
        """A path from the pose that was reported; raises a ``PlanningFailure``."""
        grid, radius_m = self.view().grid, self.footprint_radius_m + _GRAZE_M
        return plan_through(
            lambda start, end: self._planner.plan(grid, start, end, radius_m), self._pose, via, goal
        )

    def draw(self, drawing: Drawing) -> None:
        """Nobody looks on."""

    def avoid(self, position: tuple[float, float]) -> None:
        """Close a place where the caller got no farther."""
        self._tight.add(position)

    def clear_map(self, radius_m: float) -> bool:  # noqa: ARG002  # the map is the caller's
        """The caller keeps the map."""
        return False

    def reopen(self, chances: int) -> int:
        """Open such places again, unless that was done ``chances`` times before; how many."""
        return self._tight.reopen(chances)
