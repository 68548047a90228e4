"""The route planned last, kept while the new one is not clearly better."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from explore_bt.types import way_along
from explore_bt_planners.search import ClearancePrice
from explore_bt_planners.shortcut import polyline_cost, take_shortcuts
from explore_bt_planners.terrain import Terrain

__all__ = ["RouteMemory"]

_SAME_GOAL_M = 0.3
_ASTRAY_M = 0.5  # farther from the old route than this, the robot is no longer on it
_JOIN_M = 0.4  # ahead of the place nearest to the robot, where it joins the old route


@dataclass(frozen=True, slots=True, eq=False)
class _Route:
    points_m: NDArray[np.float64]
    revision: int
    lineage: int
    threshold_m: float


class RouteMemory:
    """Hysteresis: noise that a map is redrawn with makes two ways of about one price take turns.

    Only a later state of the map that the route was made on can make it worth keeping; the same question
    on the same map has the same answer, whatever was asked before.

    Args:
        reluctance: share by which a new route has to be cheaper than what is left of the old one.
    """

    def __init__(self, reluctance: float) -> None:
        self._reluctance = reluctance
        self._route: _Route | None = None

    def choose(
        self, terrain: Terrain, lineage: int, fresh: NDArray[np.float64], price: ClearancePrice
    ) -> NDArray[np.float64]:
        """The fresh route or the rest of the old one, and remember it.

        Args:
            terrain: of the map now.
            lineage: tells maps apart that are no states of one map, see ``TerrainCache``.
            fresh: (N, 2) float64 column, row as real numbers of cells: start to goal, shortened.
            price: what a metre costs.

        Returns:
            (M, 2) float64 like ``fresh``, with its first and last point.
        """
        rest = self._rest(terrain, lineage, fresh, price)
        chosen = fresh
        if rest is not None:
            limit = (1.0 + self._reluctance) * polyline_cost(
                fresh, terrain.clearance_m, price, terrain.grid.resolution_m
            )
            if polyline_cost(rest, terrain.clearance_m, price, terrain.grid.resolution_m) <= limit:
                chosen = rest
        self._route = _Route(terrain.to_metres(chosen), terrain.grid.revision, lineage, terrain.threshold_m)
        return chosen

    def _rest(
        self, terrain: Terrain, lineage: int, fresh: NDArray[np.float64], price: ClearancePrice
    ) -> NDArray[np.float64] | None:
        """The old route from the robot on, shortened for the map now; None where it does not apply."""
        old = self._route
        if (
            old is None
            or self._reluctance == 0.0
            or old.lineage != lineage
            or old.revision >= terrain.grid.revision
            or old.threshold_m != terrain.threshold_m
        ):
            return None
        start_m, goal_m = terrain.to_metres(fresh[[0, -1]])
        away_m = np.hypot(*(old.points_m - start_m).T)
        nearest = int(away_m.argmin())
        if away_m[nearest] > _ASTRAY_M or math.hypot(*(old.points_m[-1] - goal_m)) > _SAME_GOAL_M:
            return None
        ahead = nearest + int(np.searchsorted(way_along(old.points_m[nearest:]), _JOIN_M))
        res = terrain.grid.resolution_m
        points = (old.points_m[ahead:-1] - np.asarray(terrain.grid.origin_xy)) / res
        rest = np.concatenate((fresh[:1], points, fresh[-1:]))
        if math.isinf(polyline_cost(rest, terrain.clearance_m, price, terrain.grid.resolution_m)):
            return None
        return take_shortcuts(rest, terrain.clearance_m, price, res)
