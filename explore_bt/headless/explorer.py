"""The public entry for foreign loops: a map and a pose in, the next goal and path out."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import overload

from explore_bt.exploration import warm_up
from explore_bt.exploration.arguments import require_at_least, require_positive
from explore_bt.headless.decision import Decision
from explore_bt.headless.explorer_robot import ExplorerRobot
from explore_bt.headless.grid_robot import GridRobot
from explore_bt.headless.strategies import make_allocator, make_planner, read_strategy
from explore_bt.plugin import load_plugins
from explore_bt.types import OccupancyGrid, Pose2

__all__ = ["Explorer"]

_ALONE = "robot"


class Explorer:
    """Runs a strategy's behaviour tree over maps and poses that somebody else provides.

    No driver, no SLAM, no files: the very trees that missions run decide, over the skeleton planner. It keeps
    what the tree keeps (the goal committed to, waypoints, half-planes), so one explorer serves one
    exploration. Call ``decide`` whenever the map has changed: each scan, or each half metre.
    """

    def __init__(
        self,
        strategy: str | Path = "complete",
        robot_radius_m: float = 0.2,
        lidar_range_m: float = 5.0,
        safety_weight: float = 3.0,
    ) -> None:
        """Read the tree and compile every kernel (seconds the first time, then from a cache).

        Args:
            strategy: a name of ``explore_bt.headless.STRATEGIES``, or a file of trees.
            robot_radius_m: the circular footprint.
            lidar_range_m: how far the lidar sees, all round.
            safety_weight: what a metre with hardly room for the footprint costs more than one with 1.5 m of
                clearance: more gives roomier and longer ways.

        Raises:
            UserError: no such strategy, faults in its file, a length not above zero, a weight below.
        """
        require_positive(robot_radius_m=robot_radius_m, lidar_range_m=lidar_range_m)
        require_at_least(0.0, safety_weight=safety_weight)
        self._safety_weight = safety_weight
        self._radius_m, self._range_m = robot_radius_m, lidar_range_m
        self._registry = load_plugins().registry
        self._tree = read_strategy(strategy, self._registry)
        make_planner(self._registry, robot_radius_m, safety_weight)
        warm_up()
        self._robots: dict[str, ExplorerRobot] = {}

    @overload
    def decide(self, grid: OccupancyGrid, pose: Pose2) -> Decision: ...
    @overload
    def decide(self, grid: OccupancyGrid, pose: Mapping[str, Pose2]) -> dict[str, Decision]: ...
    def decide(
        self, grid: OccupancyGrid, pose: Pose2 | Mapping[str, Pose2]
    ) -> Decision | dict[str, Decision]:
        """What to do next.

        Args:
            grid: the newest map, of any resolution; it may have grown since. Its cells are frozen from then
                on: give a copy of an array that is still being written.
            pose: where the robot is, ``map`` frame; or a pose for each of several robots by name. They share
                the map, and what is left to see is divided between them by an auction.

        Returns:
            The decision, or one for each robot.
        """
        if isinstance(pose, Pose2):
            return self._robot(_ALONE).decide(grid, pose)
        robots = {name: self._robot(name) for name in pose}
        return {
            name: robot.decide(
                grid, pose[name], tuple(robots[other].as_mate(pose[other]) for other in pose if other != name)
            )
            for name, robot in robots.items()
        }

    def _robot(self, name: str) -> ExplorerRobot:
        if name not in self._robots:
            planner = make_planner(self._registry, self._radius_m, self._safety_weight)
            body = GridRobot(name, planner, self._radius_m, self._range_m, make_allocator(self._registry))
            self._robots[name] = ExplorerRobot(body, self._tree)
        return self._robots[name]
