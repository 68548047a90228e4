"""What all planners on a clearance field share: ends, connectivity, shortcuts, smoothing, the path."""

from __future__ import annotations

import contextlib
import math
from abc import abstractmethod
from collections.abc import Callable, Iterator, Sequence
from threading import Lock

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from explore_bt.errors import Cancelled, GoalBlocked, GoalUnknown, NoPath, StartBlocked
from explore_bt.interfaces import Planner, PluginOptions, RobotContext, never
from explore_bt.types import GridWindow, OccupancyGrid, Path, Pose2
from explore_bt.units import Length
from explore_bt_planners.bottleneck import widest_squared
from explore_bt_planners.endpoints import Departure, check_start, depart, settle
from explore_bt_planners.polyline import length_of, without_repeats
from explore_bt_planners.route_memory import RouteMemory
from explore_bt_planners.sampling import clearances_at, segment_is_clear
from explore_bt_planners.search import ClearancePrice
from explore_bt_planners.shortcut import take_shortcuts
from explore_bt_planners.smoothing import ClearanceFloor, smooth, turn_points
from explore_bt_planners.terrain import SLACK_M, Terrain
from explore_bt_planners.terrain_cache import TerrainCache
from explore_bt_planners.warm_up import later_states, practice_grid

__all__ = ["FieldPlanner", "FieldPlannerOptions"]

_POSE_SPACING_M = 0.1
_SAME_PLACE_M = 0.02
_ASK_S = 0.05  # how often a plan that waits for another one's end asks whether it is still wanted


class FieldPlannerOptions(PluginOptions):
    """Options of every planner on a clearance field."""

    margin: Length = Field(
        0.02, ge=0.0, description="clearance kept beyond the footprint where there is a way"
    )
    goal_tolerance: Length = Field(
        0.3,
        ge=0.0,
        description="how far a goal too close to an obstacle may be moved to where the robot fits",
    )
    leave_within: Length = Field(
        0.6, ge=0.0, description="how far a start too close to an obstacle may be from where the robot fits"
    )
    hysteresis: float = Field(
        0.1,
        ge=0.0,
        description="share by which a new route has to be cheaper than the rest of the old one, once the map "
        "has changed",
    )


class FieldPlanner(Planner):
    """Plans on the exact clearance of a map; subclasses say by which cells.

    What was derived from the map before is brought up to date where the map has changed. One plan is made
    at a time; a second caller waits.
    """

    def __init__(self, options: FieldPlannerOptions, separation: float = 1.7) -> None:
        super().__init__(options)
        self._options = options
        self._separation = separation
        self._terrains, self._memory = self._empty()
        self._busy = Lock()

    def _empty(self) -> tuple[TerrainCache, RouteMemory]:
        return TerrainCache(self._separation), RouteMemory(self._options.hysteresis)

    def setup(self, context: RobotContext) -> None:
        """Compile every kernel on a practice map that changes and grows."""
        radius_m = context.footprint_radius_m
        grid, start, goal = practice_grid(radius_m + self._options.margin)
        for state in (grid, *later_states(grid)):
            self._plan(state, start, goal, radius_m, self._options.margin, never)
        self.distances(grid, start, [goal], radius_m)
        self._terrains, self._memory = self._empty()

    def plan(
        self,
        grid: OccupancyGrid,
        start: Pose2,
        goal: Pose2,
        footprint_radius_m: float,
        cancelled: Callable[[], bool] = never,
    ) -> Path:
        """See ``Planner.plan``; the margin is given up where it leaves no way."""
        with self._turn(cancelled):
            try:
                return self._plan(grid, start, goal, footprint_radius_m, self._options.margin, cancelled)
            except (StartBlocked, GoalBlocked, NoPath) as refusal:
                if self._options.margin == 0.0:
                    raise
                with contextlib.suppress(StartBlocked, GoalBlocked, NoPath):
                    return self._plan(grid, start, goal, footprint_radius_m, 0.0, cancelled)
                raise refusal

    def distances(
        self,
        grid: OccupancyGrid,
        start: Pose2,
        goals: Sequence[Pose2],
        footprint_radius_m: float,
        cancelled: Callable[[], bool] = never,
    ) -> NDArray[np.float64]:
        """See ``Planner.distances``; for the footprint without the margin, on the map kept for plans."""
        found = np.full(len(goals), np.inf)
        with self._turn(cancelled):
            _give_up_if(cancelled)
            terrain = self._terrains.terrain(grid, footprint_radius_m)
            check_start(terrain, start)
            cells: dict[int, tuple[int, int]] = {}
            for k, goal in enumerate(goals):
                with contextlib.suppress(GoalBlocked, GoalUnknown):
                    cells[k] = settle(terrain, goal, self._options.goal_tolerance)[1]
            if not cells:
                return found
            towards = next(iter(cells.values()))
            departure = depart(terrain, start, footprint_radius_m, self._options.leave_within, towards)
            way_out = length_of(departure.points)
            lengths = self._lengths(terrain, departure.cell, np.array(list(cells.values())), cancelled)
            found[list(cells)] = (way_out + lengths) * grid.resolution_m
        return found

    def expect_change(self, before: OccupancyGrid, now: OccupancyGrid, window: GridWindow) -> None:
        """See ``Planner.expect_change``."""
        with self._turn(never):
            self._terrains.expect(before, now, window)

    @contextlib.contextmanager
    def _turn(self, cancelled: Callable[[], bool]) -> Iterator[None]:
        while not self._busy.acquire(timeout=_ASK_S):
            _give_up_if(cancelled)
        try:
            yield
        finally:
            self._busy.release()

    def _plan(
        self,
        grid: OccupancyGrid,
        start: Pose2,
        goal: Pose2,
        footprint_radius_m: float,
        margin_m: float,
        cancelled: Callable[[], bool],
    ) -> Path:
        _give_up_if(cancelled)
        terrain = self._terrains.terrain(grid, footprint_radius_m + margin_m)
        check_start(terrain, start)
        arrival, goal_cell = settle(terrain, goal, self._options.goal_tolerance)
        departure = depart(terrain, start, footprint_radius_m, self._options.leave_within, goal_cell)
        chosen = self._choose_width(terrain, departure.cell, goal_cell)
        if chosen is not terrain:
            terrain = chosen
            arrival, goal_cell = settle(terrain, goal, self._options.goal_tolerance)
            departure = depart(terrain, start, footprint_radius_m, self._options.leave_within, goal_cell)
        apart = float(np.hypot(*(arrival - departure.points[0]))) * grid.resolution_m
        if apart < _SAME_PLACE_M:
            return _path_of(terrain, departure.points[:1], goal.yaw_rad)
        polyline = self._polyline(terrain, departure, arrival, goal_cell, cancelled)
        _give_up_if(cancelled)
        points = self._smooth(terrain, departure, polyline)
        return _path_of(terrain, points, goal.yaw_rad)

    @abstractmethod
    def _route(
        self,
        terrain: Terrain,
        start: tuple[int, int],
        goal: tuple[int, int],
        cancelled: Callable[[], bool],
    ) -> NDArray[np.int64] | None:
        """(N, 2) rows and columns of passable cells from start to goal; None if nothing joins them."""

    @abstractmethod
    def _lengths(
        self,
        terrain: Terrain,
        start: tuple[int, int],
        goals: NDArray[np.int64],
        cancelled: Callable[[], bool],
    ) -> NDArray[np.float64]:
        """(N,) cells from start to each of (N, 2) rows and columns; inf where nothing joins them."""

    @abstractmethod
    def _price(self, terrain: Terrain) -> ClearancePrice:
        """What a metre costs."""

    def _choose_width(self, terrain: Terrain, start: tuple[int, int], goal: tuple[int, int]) -> Terrain:
        """The terrain to plan this way on: the one of the footprint, or one for a wider robot."""
        del start, goal
        return terrain

    def _polyline(
        self,
        terrain: Terrain,
        departure: Departure,
        arrival: NDArray[np.float64],
        goal_cell: tuple[int, int],
        cancelled: Callable[[], bool],
    ) -> NDArray[np.float64]:
        """Start, way out of a tight start, shortened route, goal."""
        price = self._price(terrain)
        begin = departure.points[-1]
        res = terrain.grid.resolution_m
        if segment_is_clear(terrain.clearance_m, *begin, *arrival, price.comfortable_m, res):
            line = np.array([begin, arrival])
        else:
            cells = self._route(terrain, departure.cell, goal_cell, cancelled)
            if cells is None:
                (x0, y0), (x1, y1) = terrain.to_metres(np.array([departure.points[0], arrival]))
                raise NoPath(
                    f"no passage from ({x0:.2f}, {y0:.2f}) to ({x1:.2f}, {y1:.2f}): "
                    + _what_is_missing(terrain, departure.cell, goal_cell)
                )
            line = without_repeats(np.concatenate((begin[None], cells[:, ::-1] + 0.5, arrival[None])))
            line = take_shortcuts(line, terrain.clearance_m, price, res)
        line = self._memory.choose(terrain, self._terrains.lineage, line, price)
        return np.concatenate((departure.points[:-1], line))

    def _smooth(
        self, terrain: Terrain, departure: Departure, polyline: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        res = terrain.grid.resolution_m
        steps = np.hypot(*np.diff(departure.points, axis=0).T)
        floor = ClearanceFloor(
            terrain.threshold_m - SLACK_M, departure.clearance_m - SLACK_M, float(steps.sum()) + 0.1 / res
        )
        return smooth(without_repeats(polyline), terrain.clearance_m, floor, _POSE_SPACING_M / res)


def _give_up_if(cancelled: Callable[[], bool]) -> None:
    if cancelled():
        raise Cancelled("the plan was cancelled by its caller")


def _path_of(terrain: Terrain, points: NDArray[np.float64], final_yaw_rad: float) -> Path:
    clearance = clearances_at(terrain.clearance_m, points)
    yaw = np.full(len(points), final_yaw_rad)
    if len(points) > 1:
        ahead = np.diff(points, axis=0)
        tangent = np.concatenate((ahead[:1], ahead[:-1] + ahead[1:], ahead[-1:]))
        turns = turn_points(points)
        tangent[turns] = ahead[turns]
        yaw[:-1] = np.arctan2(tangent[:-1, 1], tangent[:-1, 0])
    return Path(np.column_stack((terrain.to_metres(points), yaw)), clearance)


def _what_is_missing(terrain: Terrain, start: tuple[int, int], goal: tuple[int, int]) -> str:
    squared = widest_squared(terrain.transform.squared, start, goal)
    if squared is None:
        return f"nothing as wide as {2 * terrain.threshold_m:.2f} m joins them"
    if squared == 0:
        return "no known free space joins them"
    has = (math.sqrt(squared) - 0.5) * terrain.grid.resolution_m
    return (
        f"the widest way has {has:.2f} m of clearance at its narrowest place, "
        f"the footprint needs {terrain.threshold_m:.2f} m"
    )
