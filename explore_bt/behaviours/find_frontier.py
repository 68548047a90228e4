"""Leaf: the next frontier to drive up to."""

from __future__ import annotations

import math
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from explore_bt.behaviours.give_up_goal import GivenUp
from explore_bt.behaviours.search import HERE_M, Search
from explore_bt.exploration import Frontier, find_frontiers, nearest_reaching_cell, open_tour
from explore_bt.tree import Input, Status
from explore_bt.types import Pose2, Waypoint
from explore_bt.units import Length

__all__ = ["FindFrontier"]

_SAME_M = 0.5
_MOST = 12
_APART_M = 1e3


class FindFrontier(Search):
    """Picks a frontier and drives up to it, whatever could be seen from afar.

    ``order: nearest`` is Yamauchi, 1997: the nearest one that can be come to. ``order: tour`` takes the first
    of a short open tour through the twelve nearest.
    SUCCESS with a place near the frontier's middle in ``goal``; FAILURE once no frontier is left.
    """

    type_key = "find_frontier"

    order: Input[str] = Input(
        Literal["nearest", "tour"], default="nearest", doc="the nearest, or the first of a tour"
    )
    min_size: Input[float] = Input(Length, default=0.3, ge=0.0, doc="smaller ones are leaks between beams")
    within: Input[float] = Input(Length, default=1.0, ge=0.1, doc="how near the robot has to come to it")

    def update(self) -> Status:
        """Sort out the frontiers that can be come to, and pick one."""
        travel_m = self._way_m(self.here().xy)
        open_ones = self._reachable(travel_m)
        if not open_ones:
            return self.conclude(
                f"no reachable frontier of {self.min_size:.2f} m or more is left",
                ((place.looks_at or place.position, place.reason) for place in self.tried()),
            )
        place, frontier = self._pick(open_ones, travel_m)
        x, y = place
        looks_at = frontier.centroid
        pose = Pose2(x, y, math.atan2(looks_at[1] - y, looks_at[0] - x))
        self.goal = Waypoint(pose, "frontier", looks_at=looks_at)
        self.say(f"{len(open_ones)} open frontier{'' if len(open_ones) == 1 else 's'}; → ({x:.1f}, {y:.1f})")
        return Status.SUCCESS

    def _way_m(self, xy: tuple[float, float]) -> NDArray[np.float32]:
        return self.travel_m(xy, max(self.robot.least_margin_m, 0.0))

    def _reachable(self, travel_m: NDArray[np.float32]) -> list[tuple[tuple[float, float], Frontier]]:
        """Places and their frontiers; a frontier that the robot already stands at keeps its secret."""
        grid, here = self.robot.view().grid, self.here()
        found = []
        for frontier in find_frontiers(grid, self.min_size):
            cell = nearest_reaching_cell(travel_m, frontier.middle_cell, self.within / grid.resolution_m)
            if cell is None or self._is_given_up(frontier):
                continue
            place = grid.center_of(*cell)
            if math.dist(place, here.xy) <= HERE_M:
                reason = "still unknown after looking from here"
                self.give_up(GivenUp(place, reason, frontier.centroid, was_seen=True))
                continue
            found.append((place, frontier))
        return found

    def _pick(
        self, open_ones: list[tuple[tuple[float, float], Frontier]], travel_m: NDArray[np.float32]
    ) -> tuple[tuple[float, float], Frontier]:
        grid = self.robot.view().grid
        open_ones = sorted(open_ones, key=lambda each: float(travel_m[grid.cell_of(*each[0])]))
        if self.order == "nearest":
            return open_ones[0]
        chosen = open_ones[:_MOST]
        fields = [travel_m, *(self._way_m(place) for place, _ in chosen)]
        cells = grid.cells_of(np.array([self.here().xy, *(place for place, _ in chosen)]))
        between = np.array([field[tuple(cells.T)] for field in fields], dtype=np.float64)
        tour = open_tour(np.where(np.isfinite(between), between, _APART_M))
        return chosen[int(tour[1]) - 1]

    def _is_given_up(self, frontier: Frontier) -> bool:
        looks = [place.looks_at for place in self.tried() if place.looks_at is not None]
        return any(math.dist(look, frontier.centroid) < _SAME_M for look in looks)
