"""Planner ``skeleton``: along the medial axis of the known free space."""

from __future__ import annotations

import contextlib
import math
from collections.abc import Callable, Iterable, Iterator
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from explore_bt.interfaces import API_VERSION, PluginOptions
from explore_bt.units import Length
from explore_bt_planners.ascent import ascend
from explore_bt_planners.bottleneck import widest_squared
from explore_bt_planners.field_planner import FieldPlanner, FieldPlannerOptions
from explore_bt_planners.search import ClearancePrice, find_costs, find_route
from explore_bt_planners.terrain import Terrain

__all__ = ["Skeleton", "SkeletonOptions"]


class SkeletonOptions(FieldPlannerOptions):
    """Options of the planner ``skeleton``."""

    separation: float = Field(
        1.7, gt=0.0, description="two obstacles this many footprints (with margin) apart make a medial axis"
    )
    comfortable: Length = Field(0.6, ge=0.0, description="clearance beyond which more is worth nothing")
    clearance_weight: float = Field(
        1.5, ge=0.0, description="what a metre at the least clearance costs more than a comfortable one"
    )
    slow_below: Length = Field(
        0.0,
        ge=0.0,
        description="room beside the footprint (with margin) under which the controller slows down; above 0, "
        "a metre costs the time it takes, whatever the other two prices say",
    )
    widest: bool = Field(
        False, description="take the way whose narrowest place is the widest there is, however long it gets"
    )


class Skeleton(FieldPlanner):
    """Up the clearance to the medial axis, along it, down to the goal; then shortened and smoothed.

    The medial axis is the generalised Voronoi diagram of the obstacles, unknown space being one.
    """

    name: ClassVar[str] = "skeleton"
    api_version: ClassVar[int] = API_VERSION
    Options: ClassVar[type[PluginOptions]] = SkeletonOptions

    def __init__(self, options: SkeletonOptions) -> None:
        super().__init__(options, options.separation)
        self._taste = options

    def _price(self, terrain: Terrain) -> ClearancePrice:
        if self._taste.slow_below:
            full_m = terrain.threshold_m + self._taste.slow_below
            return ClearancePrice(terrain.threshold_m, full_m, 0.0, self._taste.slow_below)
        comfortable = max(self._taste.comfortable, terrain.threshold_m)
        return ClearancePrice(terrain.threshold_m, comfortable, self._taste.clearance_weight)

    def _route(
        self,
        terrain: Terrain,
        start: tuple[int, int],
        goal: tuple[int, int],
        cancelled: Callable[[], bool],
    ) -> NDArray[np.int64] | None:
        """On the skeleton and the two ways up to it; through all passable cells if that does not join."""
        route = self._along_skeleton(terrain, start, goal, cancelled)
        if route is None and terrain.joins(start, goal):
            route = self._search(terrain, terrain.passable, start, goal, cancelled)
        return route

    def _along_skeleton(
        self,
        terrain: Terrain,
        start: tuple[int, int],
        goal: tuple[int, int],
        cancelled: Callable[[], bool],
    ) -> NDArray[np.int64] | None:
        with _opened(terrain, [start, goal]) as allowed:
            return self._search(terrain, allowed, start, goal, cancelled)

    def _lengths(
        self,
        terrain: Terrain,
        start: tuple[int, int],
        goals: NDArray[np.int64],
        cancelled: Callable[[], bool],
    ) -> NDArray[np.float64]:
        """Along the skeleton: the order of the goals is what counts, and plans shorten all ways alike."""
        free_of_charge = ClearancePrice(terrain.threshold_m, terrain.threshold_m, 0.0)
        with _opened(terrain, [start, *((int(row), int(col)) for row, col in goals)]) as allowed:
            return find_costs(
                allowed, terrain.passable, terrain.clearance_m, free_of_charge, start, goals, cancelled
            )

    def _search(
        self,
        terrain: Terrain,
        allowed: NDArray[np.bool_],
        start: tuple[int, int],
        goal: tuple[int, int],
        cancelled: Callable[[], bool],
    ) -> NDArray[np.int64] | None:
        price = self._price(terrain)
        return find_route(allowed, terrain.passable, terrain.clearance_m, price, start, goal, cancelled)

    def _choose_width(self, terrain: Terrain, start: tuple[int, int], goal: tuple[int, int]) -> Terrain:
        """The widest robot for which there is a way: a way for it is the widest passage."""
        if not self._taste.widest:
            return terrain
        squared = widest_squared(terrain.transform.squared, start, goal, terrain.transform.squared.size)
        if squared is None or squared <= terrain.min_squared:
            return terrain
        clearance_m = (math.sqrt(squared) - 0.5) * terrain.grid.resolution_m
        return Terrain(terrain.grid, clearance_m, self._taste.separation, terrain.transform)


@contextlib.contextmanager
def _opened(terrain: Terrain, ends: Iterable[tuple[int, int]]) -> Iterator[NDArray[np.bool_]]:
    """The skeleton with the ways up to it, for one search: a copy of a large map costs more than that."""
    skeleton, ways = terrain.skeleton, []
    for row, col in ends:
        way = ascend(terrain.transform.squared, terrain.passable, skeleton, row, col)
        ways.append(way[~skeleton[way[:, 0], way[:, 1]]].T)
        skeleton[tuple(ways[-1])] = True
    try:
        yield skeleton
    finally:
        for way in ways:
            skeleton[tuple(way)] = False
