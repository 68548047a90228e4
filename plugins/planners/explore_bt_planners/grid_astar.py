"""Planner ``grid_astar``: the shortest way through all cells where the footprint fits."""

from __future__ import annotations

from collections.abc import Callable
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from explore_bt.interfaces import API_VERSION, PluginOptions
from explore_bt_planners.field_planner import FieldPlanner, FieldPlannerOptions
from explore_bt_planners.search import ClearancePrice, find_costs, find_route
from explore_bt_planners.terrain import Terrain

__all__ = ["GridAstar", "GridAstarOptions"]


class GridAstarOptions(FieldPlannerOptions):
    """Options of the planner ``grid_astar``."""


class GridAstar(FieldPlanner):
    """Hart, Nilsson and Raphael's A* (1968), 8-connected; shortest, hence as close to walls as allowed."""

    name: ClassVar[str] = "grid_astar"
    api_version: ClassVar[int] = API_VERSION
    Options: ClassVar[type[PluginOptions]] = GridAstarOptions

    def __init__(self, options: GridAstarOptions) -> None:
        super().__init__(options)

    def _price(self, terrain: Terrain) -> ClearancePrice:
        return ClearancePrice(terrain.threshold_m, terrain.threshold_m, 0.0)

    def _route(
        self,
        terrain: Terrain,
        start: tuple[int, int],
        goal: tuple[int, int],
        cancelled: Callable[[], bool],
    ) -> NDArray[np.int64] | None:
        if not terrain.joins(start, goal):
            return None
        return find_route(
            terrain.passable,
            terrain.passable,
            terrain.clearance_m,
            self._price(terrain),
            start,
            goal,
            cancelled,
        )

    def _lengths(
        self,
        terrain: Terrain,
        start: tuple[int, int],
        goals: NDArray[np.int64],
        cancelled: Callable[[], bool],
    ) -> NDArray[np.float64]:
        return find_costs(
            terrain.passable,
            terrain.passable,
            terrain.clearance_m,
            self._price(terrain),
            start,
            goals,
            cancelled,
        )
