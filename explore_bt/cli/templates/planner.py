"""A planner that takes the shortest way over the cells in which the footprint fits."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray
from pydantic import Field
from scipy.sparse import coo_array
from scipy.sparse.csgraph import dijkstra

from explore_bt import hookimpl
from explore_bt.errors import Cancelled, GoalBlocked, GoalUnknown, NoPath, StartBlocked
from explore_bt.interfaces import API_VERSION, MapView, Planner, PluginOptions, never
from explore_bt.types import UNKNOWN, OccupancyGrid, Path, Pose2
from explore_bt.units import Length

Cell = tuple[int, int]

_STEPS = ((0, 1), (1, 0), (1, 1), (1, -1))


class MyPlugin(Planner):
    """Plans the shortest way on the grid, from cell to neighbouring cell."""

    name = "my_plugin"
    api_version = API_VERSION

    class Options(PluginOptions):
        """What a mission may set: ``planner: {use: my_plugin, margin: 5 cm}``."""

        margin: Length = Field(0.0, ge=0.0, description="clearance asked for beyond the footprint's radius")

    options: Options

    def plan(
        self,
        grid: OccupancyGrid,
        start: Pose2,
        goal: Pose2,
        footprint_radius_m: float,
        cancelled: Callable[[], bool] = never,
    ) -> Path:
        """Out of a tight place first, then from cell to cell, to the goal itself."""
        if grid.value_at(*goal.xy) == UNKNOWN:
            raise GoalUnknown(f"the goal ({goal.x:.2f}, {goal.y:.2f}) lies in unknown space")
        clearance = MapView(grid).clearance_m
        fits = clearance >= footprint_radius_m + self.options.margin
        last = grid.cell_of(*goal.xy)
        if not fits[last]:
            raise GoalBlocked(f"clearance at the goal is {clearance[last]:.2f} m")
        way_out = _way_out(clearance, fits, grid.cell_of(*start.xy))
        if cancelled():
            raise Cancelled("the caller gave up")
        cells = [*way_out[:-1], *_shortest(fits, way_out[-1], last)]
        return _path(grid, start, cells, goal, clearance)


def _way_out(clearance: NDArray[np.float32], fits: NDArray[np.bool_], cell: Cell) -> list[Cell]:
    """From a cell up the clearance to the first one that fits; that cell alone if it fits itself."""
    rows, cols = fits.shape
    way = [cell]
    if not (0 <= cell[0] < rows and 0 <= cell[1] < cols) or clearance[cell] <= 0.0:
        raise StartBlocked("the robot stands in an obstacle or outside of what is known")
    while not fits[way[-1]]:
        row, col = way[-1]
        around = [
            (r, c)
            for r in range(max(row - 1, 0), min(row + 2, rows))
            for c in range(max(col - 1, 0), min(col + 2, cols))
        ]
        best = max(around, key=lambda each: clearance[each])
        if clearance[best] <= clearance[row, col]:
            raise StartBlocked(
                f"clearance is {clearance[cell]:.2f} m at the start and grows no further around it"
            )
        way.append(best)
    return way


def _shortest(fits: NDArray[np.bool_], first: Cell, last: Cell) -> list[Cell]:
    """Dijkstra's algorithm over the 8-connected cells that fit, ends included."""
    number = np.cumsum(fits).reshape(fits.shape) - 1
    rows, cols = fits.shape
    begins, ends, lengths = [], [], []
    for down, right in _STEPS:
        here = (slice(0, rows - down), slice(max(-right, 0), cols - max(right, 0)))
        there = (slice(down, rows), slice(max(right, 0), cols + min(right, 0)))
        both = fits[here] & fits[there]
        begins.append(number[here][both])
        ends.append(number[there][both])
        lengths.append(np.full(int(both.sum()), np.hypot(down, right)))
    size = int(fits.sum())
    joined = (np.concatenate(begins), np.concatenate(ends))
    graph = coo_array((np.concatenate(lengths), joined), shape=(size, size)).tocsr()
    _, before = dijkstra(graph, directed=False, indices=number[last], return_predecessors=True)
    cells, node, where = [first], int(number[first]), np.argwhere(fits)
    while node != number[last]:
        node = int(before[node])
        if node < 0:
            raise NoPath("no passage is wide enough")
        cells.append((int(where[node, 0]), int(where[node, 1])))
    return cells


def _path(
    grid: OccupancyGrid, start: Pose2, cells: list[Cell], goal: Pose2, clearance: NDArray[np.float32]
) -> Path:
    """The start itself, the centres of the cells between, the goal itself; each looks at the next."""
    between = [grid.center_of(*cell) for cell in cells[1:-1]]
    xy = np.array([start.xy, *between, goal.xy])
    if start.distance_to(goal) < 1e-6:
        return Path(goal.as_array()[None, :], np.array([float(clearance[cells[-1]])]))
    steps = np.diff(xy, axis=0)
    yaw = np.append(np.arctan2(steps[:, 1], steps[:, 0]), goal.yaw_rad)
    rows, cols = grid.cells_of(xy).T
    return Path(np.column_stack((xy, yaw)), clearance[rows, cols].astype(np.float64))


@hookimpl
def explore_bt_register() -> Sequence[type]:
    """What this distribution brings."""
    return [MyPlugin]
