"""The stage of an exploration trial: a world from a file, a drawer of maps, starts, the floor to be seen."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from explore_bt_drivers.world import SPARE_M, World, load_world, observable_floor
from explore_bt_drivers.world.observable import reachable_cells
from explore_bt_planners.feature_transform import feature_transform
from explore_bt_planners.medial_axis import medial_axis
from explore_bt_slam.canvas import Canvas
from explore_bt_slam.sweep import Sweep
from numpy.typing import NDArray

from explore_bt.evaluation import spread_starts
from explore_bt.exploration import clearance_field
from explore_bt.types import OccupancyGrid, Pose2

__all__ = ["CanvasDrawer", "Stage", "set_stage"]

MAP_RESOLUTION_M = 0.05
_INTO_THE_WALL_M = 0.001
"""Walls that follow the cells return from the border between two: rounding should not say which is solid."""


class CanvasDrawer:
    """Draws scans as the SLAM plugins do, at poses that are true."""

    def __init__(self, radius_m: float, range_m: float) -> None:
        self._canvas = Canvas(MAP_RESOLUTION_M, radius_m)
        self._range_m = range_m

    def see(self, pose: Pose2, angles_rad: NDArray[np.float64], ranges_m: NDArray[np.float64]) -> None:
        """Draw one scan."""
        reach = np.minimum(ranges_m + _INTO_THE_WALL_M, self._range_m)
        ends = np.column_stack((reach * np.cos(angles_rad), reach * np.sin(angles_rad))).astype(np.float32)
        sweep = Sweep(0.0, np.zeros_like(ends), ends, np.isfinite(ranges_m))
        self._canvas.draw(sweep, Pose2(*pose.xy, 0.0))  # the directions are the map's already

    def grid(self) -> OccupancyGrid:
        """The map so far."""
        return self._canvas.snapshot()


@dataclass(frozen=True, slots=True, eq=False)
class Stage:
    """All that trials on one map share.

    Attributes:
        reachable: (rows, cols) bool over ``world.floor``: where the robot can come, with 2.5 cm to spare.
        floor: the floor to be seen from there, ``FREE``.
        clearance_bound_m: mean over the medial axis of ``reachable``: who keeps to the middle has it.
        starts: as many as asked for.
    """

    name: str
    world: World
    reachable: NDArray[np.bool_]
    floor: OccupancyGrid
    starts: tuple[Pose2, ...]
    clearance_bound_m: float


def set_stage(
    path: Path, radius_m: float, range_m: float, count: int, seed: int, given: Sequence[Pose2] = ()
) -> Stage:
    """Load a world and find starts in it.

    Args:
        path: a map_server map or a world of ours.
        radius_m: r of the footprint.
        range_m: the lidar's.
        count: of starts.
        seed: of the starts.
        given: starts to take instead.

    Raises:
        WorldError: the file is faulty, or no place is wide enough.
    """
    world = load_world(path)
    starts = tuple(given) or spread_starts(world.floor, radius_m + SPARE_M, count, seed)
    reachable = reachable_cells(world, starts[0].xy, radius_m + SPARE_M)
    floor = observable_floor(world, starts[0].xy, radius_m + SPARE_M, range_m)
    bound_m = _axis_clearance_m(world.floor, reachable, radius_m)
    return Stage(path.stem, world, reachable, floor, starts, bound_m)


def _axis_clearance_m(floor: OccupancyGrid, reachable: NDArray[np.bool_], radius_m: float) -> float:
    """Mean clearance of the medial axis that the planner ``skeleton`` drives along."""
    transform = feature_transform(floor.cells)
    separation = 1.7 * radius_m / floor.resolution_m
    axis = medial_axis(transform, 1, separation) & reachable
    return float(clearance_field(floor)[axis].mean()) if axis.any() else 0.0
