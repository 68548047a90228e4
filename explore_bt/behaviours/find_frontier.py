"""Leaf: the next frontier to drive up to."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from explore_bt.behaviours.give_up_goal import GivenUp
from explore_bt.behaviours.search import HERE_M, Search
from explore_bt.behaviours.share import allotted, claims_of_others, free_at, workers
from explore_bt.exploration import Frontier, find_frontiers, nearest_reaching_cell, open_tour
from explore_bt.tree import Input, Status
from explore_bt.types import Drawing, FrontierMark, Pose2, Verdict, Waypoint
from explore_bt.units import Length

__all__ = ["FindFrontier"]

_SAME_M = 0.5
_MOST = 12
_APART_M = 1e3
_MOST_FOR_EACH = 3
_CLAIMED_M = 2.0
"""A frontier so near to where another robot goes is its own."""


class FindFrontier(Search):
    """Picks a frontier and drives up to it, whatever could be seen from afar.

    ``order: nearest`` is Yamauchi, 1997: the nearest one that can be come to. ``order: tour`` takes the first
    of a short open tour through the twelve nearest. In a team, frontiers that others go to are left to them,
    and the rest is divided by the mission's allocator.
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
        open_ones, shut = self._sorted_out(travel_m)
        mine = self._own_share(open_ones, travel_m) if open_ones else []
        left_to_others, open_ones = len(open_ones) - len(mine), mine
        if not open_ones:
            self.robot.team.claim(())
            self._draw(shut)
            if left_to_others:
                return self.conclude(f"what is left is left to others: {left_to_others} frontiers", ())
            return self.conclude(
                f"no reachable frontier of {self.min_size:.2f} m or more is left",
                ((place.looks_at or place.position, place.reason) for place in self.tried()),
            )
        place, frontier = self._pick(open_ones, travel_m)
        x, y = place
        looks_at = frontier.centroid
        pose = Pose2(x, y, math.atan2(looks_at[1] - y, looks_at[0] - x))
        self.goal = Waypoint(pose, "frontier", looks_at=looks_at)
        self.robot.team.claim([(x, y)])
        reason = f"→ ({x:.1f}, {y:.1f}), {travel_m[self.robot.view().grid.cell_of(x, y)]:.1f} m away"
        taken = _mark(frontier, Verdict.TAKEN, reason)
        self._draw((taken, *(_mark(each) for _, each in open_ones if each is not frontier), *shut))
        self.say(f"{len(open_ones)} open frontier{'' if len(open_ones) == 1 else 's'}; {reason}")
        return Status.SUCCESS

    def _draw(self, marks: Iterable[FrontierMark]) -> None:
        self.robot.draw(Drawing(frontiers=tuple(marks)))

    def _way_m(self, xy: tuple[float, float]) -> NDArray[np.float32]:
        return self.travel_m(xy, max(self.robot.least_margin_m, 0.0))

    def _sorted_out(
        self, travel_m: NDArray[np.float32]
    ) -> tuple[list[tuple[tuple[float, float], Frontier]], list[FrontierMark]]:
        """Frontiers with the places to go to, and those that are not gone to.

        One that the robot already stands at keeps its secret.
        """
        grid, here = self.robot.view().grid, self.here()
        found, shut = [], []
        for frontier in find_frontiers(grid, self.min_size):
            cell = nearest_reaching_cell(travel_m, frontier.middle_cell, self.within / grid.resolution_m)
            reason = self._given_up_for(frontier)
            if cell is None:
                reason = f"no way leads to within {self.within:.1f} m of it"
            elif not reason and math.dist(place := grid.center_of(*cell), here.xy) <= HERE_M:
                reason = "still unknown after looking from here"
                self.give_up(GivenUp(place, reason, frontier.centroid, was_seen=True))
            if cell is None or reason:
                shut.append(_mark(frontier, Verdict.REJECTED, reason))
            else:
                found.append((grid.center_of(*cell), frontier))
        return found, shut

    def _own_share(
        self, open_ones: list[tuple[tuple[float, float], Frontier]], travel_m: NDArray[np.float32]
    ) -> list[tuple[tuple[float, float], Frontier]]:
        """Those of the nearest frontiers that are this robot's; all of them without a team."""
        mates = workers(self.robot)
        if not mates:
            return open_ones
        goal: Waypoint | None = self.recall("goal", None)
        present = np.array([] if goal is None else [goal.position]).reshape(-1, 2)
        claims = claims_of_others(self.robot, present)
        left = [each for each in open_ones if not _is_near(each[0], claims, _CLAIMED_M)]
        left = sorted(left, key=lambda each: float(travel_m[self.robot.view().grid.cell_of(*each[0])]))
        chosen = left[: _MOST + _MOST_FOR_EACH * len(mates)]
        if not chosen:
            return []
        between = self._between_m(travel_m, [place for place, _ in chosen])
        cells = self.robot.view().grid.cells_of(np.array([place for place, _ in chosen]))
        others = np.array([self._way_m(free_at(mate))[tuple(cells.T)] for mate in mates], dtype=np.float64)
        kept = np.array([_is_near(place, present, _SAME_M) for place, _ in chosen])
        sizes = [frontier.size_m for _, frontier in chosen]
        from_others = np.where(np.isfinite(others), others, _APART_M)
        return [chosen[k] for k in allotted(self.robot, mates, sizes, between, from_others, kept)]

    def _between_m(
        self, travel_m: NDArray[np.float32], places: list[tuple[float, float]]
    ) -> NDArray[np.float64]:
        """(N + 1, N + 1) metres between the robot (first) and places."""
        fields = [travel_m, *(self._way_m(place) for place in places)]
        cells = self.robot.view().grid.cells_of(np.array([self.here().xy, *places]))
        between = np.array([field[tuple(cells.T)] for field in fields], dtype=np.float64)
        return np.where(np.isfinite(between), between, _APART_M)

    def _pick(
        self, open_ones: list[tuple[tuple[float, float], Frontier]], travel_m: NDArray[np.float32]
    ) -> tuple[tuple[float, float], Frontier]:
        grid = self.robot.view().grid
        open_ones = sorted(open_ones, key=lambda each: float(travel_m[grid.cell_of(*each[0])]))
        if self.order == "nearest":
            return open_ones[0]
        chosen = open_ones[:_MOST]
        tour = open_tour(self._between_m(travel_m, [place for place, _ in chosen]))
        return chosen[int(tour[1]) - 1]

    def _given_up_for(self, frontier: Frontier) -> str:
        """Why it is not tried again; empty if it may be."""
        for place in self.tried():
            if place.looks_at is not None and math.dist(place.looks_at, frontier.centroid) < _SAME_M:
                return f"given up before: {place.reason}"
        return ""


def _is_near(place: tuple[float, float], places: NDArray[np.float64], within_m: float) -> bool:
    return bool((np.hypot(*(places - place).T) < within_m).any())


def _mark(frontier: Frontier, state: Verdict = Verdict.OPEN, reason: str = "") -> FrontierMark:
    return FrontierMark(*frontier.centroid, frontier.size_m, state, reason)
