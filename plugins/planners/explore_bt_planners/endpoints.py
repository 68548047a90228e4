"""Where a plan may begin and end, and the typed refusals when it may not."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from explore_bt.errors import GoalBlocked, GoalUnknown, StartBlocked
from explore_bt.types import OCCUPIED, UNKNOWN, Pose2
from explore_bt_planners.ascent import ascend, nearest_target
from explore_bt_planners.sampling import clearance_at
from explore_bt_planners.terrain import SLACK_M, Terrain

__all__ = ["Departure", "check_start", "depart", "settle"]


@dataclass(frozen=True, slots=True, eq=False)
class Departure:
    """How the robot gets from where it stands to passable space.

    Attributes:
        points: (N, 2) float64 column, row as real numbers: the start itself, then centres of cells. Only
            the start, if it is clear enough.
        cell: (row, col) of the first passable cell.
        clearance_m: of the start.
    """

    points: NDArray[np.float64]
    cell: tuple[int, int]
    clearance_m: float


def check_start(terrain: Terrain, start: Pose2) -> None:
    """Whether the robot can stand at the start at all.

    Raises:
        StartBlocked: it lies outside of the map or in an occupied cell.
    """
    cell = terrain.grid.cell_of(start.x, start.y)
    if not terrain.grid.contains_cell(*cell):
        raise StartBlocked(_at("the start", start, terrain, ""))
    if terrain.grid.cells[cell] == OCCUPIED:
        raise StartBlocked(_at("the start", start, terrain, "an occupied cell"))


def depart(
    terrain: Terrain,
    start: Pose2,
    footprint_radius_m: float,
    within_m: float,
    goal_cell: tuple[int, int],
) -> Departure:
    """The way out of a start that may be tighter than the robot needs.

    Cells that nobody has seen under the robot's own footprint are walked: it stands on them. A start in
    the middle of a narrow passage is left to the goal's side. The start has passed ``check_start``.

    Raises:
        StartBlocked: no passable cell can be reached within ``within_m``.
    """
    grid = terrain.grid
    cell = grid.cell_of(start.x, start.y)
    point = np.array([terrain.to_cells(start.x, start.y)])
    clearance = float(clearance_at(terrain.clearance_m, point[0, 0], point[0, 1]))
    if clearance >= terrain.threshold_m - SLACK_M:
        return Departure(point, cell, clearance)
    way = ascend(terrain.transform.squared, grid.free, terrain.passable, *cell)
    goal_side = terrain.passable & (terrain.component == terrain.component[goal_cell])
    if not goal_side[tuple(way[-1])] or _span(way) * grid.resolution_m > within_m:
        walkable = grid.free | (grid.unknown & _disc(terrain, cell, footprint_radius_m))
        reach = within_m / grid.resolution_m
        around = nearest_target(walkable, goal_side, cell, reach)
        if around is None:
            around = nearest_target(walkable, terrain.passable, cell, reach)
        if around is None:
            raise StartBlocked(
                f"the start ({start.x:.2f}, {start.y:.2f}) has {clearance:.2f} m of clearance, the footprint "
                f"needs {terrain.threshold_m:.2f} m, and no place within {within_m:.1f} m has it"
            )
        way = around
    points = np.concatenate((point, way[:, ::-1] + 0.5))
    return Departure(points, (int(way[-1, 0]), int(way[-1, 1])), clearance)


def settle(terrain: Terrain, goal: Pose2, tolerance_m: float) -> tuple[NDArray[np.float64], tuple[int, int]]:
    """The place to arrive at: the goal, or the nearest clear enough place uphill from it.

    Returns:
        (2,) float64 column and row as real numbers, and the passable cell (row, col) that holds it.

    Raises:
        GoalUnknown: the goal lies in unknown space or outside of the map.
        GoalBlocked: it is occupied, or the footprint does not fit there nor within the tolerance uphill.
    """
    grid = terrain.grid
    cell = grid.cell_of(goal.x, goal.y)
    if not grid.contains_cell(*cell) or grid.cells[cell] == UNKNOWN:
        raise GoalUnknown(
            _at("the goal", goal, terrain, "unknown space" if grid.contains_cell(*cell) else "")
        )
    if grid.cells[cell] == OCCUPIED:
        raise GoalBlocked(_at("the goal", goal, terrain, "an occupied cell"))
    point = np.array(terrain.to_cells(goal.x, goal.y))
    if clearance_at(terrain.clearance_m, point[0], point[1]) >= terrain.threshold_m - SLACK_M:
        return point, cell
    way = ascend(terrain.transform.squared, grid.free, terrain.passable, *cell)
    last = (int(way[-1, 0]), int(way[-1, 1]))
    center = np.array([last[1] + 0.5, last[0] + 0.5])
    # half a cell's diagonal is the price of a grid: a clear cell is good enough for a goal inside it
    reach = max(tolerance_m / grid.resolution_m, 0.75)
    if not terrain.passable[last] or math.hypot(*(center - point)) > reach:
        raise GoalBlocked(
            f"the goal ({goal.x:.2f}, {goal.y:.2f}) has {float(terrain.clearance_m[cell]):.2f} m of "
            f"clearance, the footprint needs {terrain.threshold_m:.2f} m, and no place uphill within "
            f"{tolerance_m:.2f} m has it"
        )
    return center, last


def _at(what: str, pose: Pose2, terrain: Terrain, inside: str) -> str:
    rows, cols = terrain.grid.shape
    place = f"{what} ({pose.x:.2f}, {pose.y:.2f}) lies"
    if inside:
        return f"{place} in {inside}"
    ox, oy = terrain.grid.origin_xy
    res = terrain.grid.resolution_m
    x, y = ox + cols * res, oy + rows * res
    return f"{place} outside of the map, x {ox:.2f} to {x:.2f}, y {oy:.2f} to {y:.2f}"


def _span(way: NDArray[np.int64]) -> float:
    """Cells from the first to the last of a way, as the crow flies."""
    return math.hypot(*(way[-1] - way[0]))


def _disc(terrain: Terrain, cell: tuple[int, int], radius_m: float) -> NDArray[np.bool_]:
    rows, cols = terrain.grid.shape
    r, c = np.ogrid[:rows, :cols]
    return ((r - cell[0]) ** 2 + (c - cell[1]) ** 2) <= (radius_m / terrain.grid.resolution_m) ** 2
