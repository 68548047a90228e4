"""Leaf: backtrack to the best reachable place that still shows new area, or tell that there is none."""

from __future__ import annotations

import math

import numpy as np

from explore_bt.behaviours.give_up_goal import GivenUp
from explore_bt.exploration import (
    Frontier,
    Viewpoint,
    ViewpointChoice,
    choose_viewpoints,
    find_frontiers,
    travel_field,
)
from explore_bt.tree import Input, Key, Leaf, Output, Status
from explore_bt.types import Pose2, Waypoint
from explore_bt.units import Area, Length

__all__ = ["FindViewpoint"]

_HERE_M = 0.3
_SQUEEZE_M = 0.03  # half a cell and a little: where nothing else is left, the finer gate decides
_SAME_FRONTIER_M = 0.5
_TRIES = 3
_WORTH_M_PER_M2 = 0.3
_MOST_WORTH_M2 = 6.0


class FindViewpoint(Leaf):
    """Looks over the whole map for a frontier worth a drive, and picks where to see it from.

    Of all places that see a reachable frontier it takes the nearest, where each square metre expected
    there counts as 0.3 m less of a way. A place that the robot already stands at and that still promises
    new area has broken its promise and is not tried again.
    SUCCESS with the place in ``goal``; FAILURE once nothing is left, with every frontier that stays open
    and why in ``left_open``.
    """

    type_key = "find_viewpoint"

    min_gain: Input[float] = Input(Area, default=0.1, ge=0.0, doc="new area that is worth a drive")
    min_size: Input[float] = Input(
        Length, default=0.15, ge=0.0, doc="shorter frontiers are leaks between beams"
    )
    margin: Input[float] = Input(
        Length,
        default=0.02,
        ge=0.0,
        doc="free space beyond the footprint, given up as the last resort",
    )
    goal: Output[Waypoint] = Output(Waypoint, default=Key("goal"), doc="the place, heading for the frontier")
    given_up: Output[tuple[GivenUp, ...]] = Output(
        tuple, default=Key("given_up"), doc="places not to try again"
    )
    left_open: Output[tuple[str, ...]] = Output(
        tuple, default=Key("left_open"), doc="what was not explored and why, one sentence each"
    )
    reason: Output[str] = Output(str, default=Key("reason"), doc="why the exploration is over")

    def update(self) -> Status:
        """Choose among all viewpoints of the newest map; through tight passages only for want of others."""
        for margin_m in dict.fromkeys((self.margin, 0.0, -_SQUEEZE_M)):
            choice = self._choice(margin_m)
            while choice.viewpoints:
                best = min(choice.viewpoints, key=_cost_m)
                if best.travel_m > _HERE_M:
                    return self._take(best, len(choice.viewpoints))
                self._give_up(best)
                choice = self._choice(margin_m)
        return self._conclude(choice)

    def _choice(self, margin_m: float) -> ViewpointChoice:
        view = self.robot.view()
        grid, clearance_m = view.grid, view.clearance_m
        radius_m = self.robot.footprint_radius_m + margin_m
        here = grid.cell_of(*self.robot.estimate().T_map_base.xy)
        travel_m = travel_field(clearance_m, np.array([here]), radius_m, grid.resolution_m)
        return choose_viewpoints(
            grid,
            clearance_m,
            travel_m,
            [frontier for frontier in find_frontiers(grid, self.min_size) if not self._is_given_up(frontier)],
            self.robot.lidar_range_m,
            radius_m=radius_m,
            min_gain_m2=self.min_gain,
            tried=[place.position for place in self._tried()],
        )

    def _take(self, best: Viewpoint, count: int) -> Status:
        x, y = best.xy
        pose = Pose2(x, y, best.heading_rad)
        self.goal = Waypoint(pose, "backtrack", best.gain_m2, best.frontier.centroid)
        self.say(
            f"{count} open frontier{'' if count == 1 else 's'}; "
            f"→ ({x:.1f}, {y:.1f}), {best.travel_m:.1f} m away, {best.gain_m2:.1f} m² to see"
        )
        return Status.SUCCESS

    def _give_up(self, place: Viewpoint) -> None:
        reason = f"still {place.gain_m2:.1f} m² unknown after looking from here"
        self.given_up = (*self._tried(), GivenUp(place.xy, reason, place.frontier.centroid, was_seen=True))

    def _is_given_up(self, frontier: Frontier) -> bool:
        """Whether enough places that were to show this frontier have failed."""
        looks = [place.looks_at for place in self._tried() if place.looks_at is not None]
        return sum(math.dist(look, frontier.centroid) < _SAME_FRONTIER_M for look in looks) >= _TRIES

    def _tried(self) -> tuple[GivenUp, ...]:
        return self.recall("given_up", ())

    def _conclude(self, choice: ViewpointChoice) -> Status:
        """Name what stays open, frontiers with the same reason together."""
        open_at: dict[str, list[tuple[float, float]]] = {}
        for left in choice.left_open:
            if not left.is_closed:
                open_at.setdefault(left.reason, []).append(left.frontier.centroid)
        for place in self._tried():
            open_at.setdefault(place.reason, []).append(place.position)
        self.left_open = tuple(_sentence(positions, reason) for reason, positions in open_at.items())
        self.reason = f"no reachable frontier shows {self.min_gain:.2f} m² of new area or more"
        self.say(self.reason)
        return Status.FAILURE


def _cost_m(place: Viewpoint) -> float:
    return place.travel_m - _WORTH_M_PER_M2 * min(place.gain_m2, _MOST_WORTH_M2)


def _sentence(positions: list[tuple[float, float]], reason: str) -> str:
    x, y = positions[0]
    more = f" and {len(positions) - 1} more" if len(positions) > 1 else ""
    return f"({x:.1f}, {y:.1f}){more}: {reason}"
