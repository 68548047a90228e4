"""Leaf: the place to look from next, by what the lidar will see from it."""

from __future__ import annotations

import math
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from explore_bt.behaviours.give_up_goal import GivenUp
from explore_bt.exploration import (
    HalfPlaneHistory,
    Outlooks,
    TourTaste,
    View,
    ViewPlaces,
    ViewSet,
    choose_views,
    find_free_sectors,
    next_waypoint,
    order_by_safety,
    order_views,
    sentences,
    travel_field,
    visible_unknown_area,
    what_remains,
)
from explore_bt.tree import Input, Key, Leaf, Output, Status
from explore_bt.types import Pose2, Waypoint, wrap_angle
from explore_bt.units import Area, Length

__all__ = ["FindView"]

_HERE_M = 0.15
_MARGIN_M = 0.02
_TRIES = 20
_SCRAP_M2 = 0.5


class FindView(Leaf):
    """Picks the next place to look from among the safe headings' waypoints and the skeleton's places.

    The paper's rules go on: headings into free sectors give waypoints (1–3), the half-plane of the last
    waypoint makes turning back cost (4), a place looked from in vain is not visited again (5), and every
    place counts by the new area in view (6). What the paper leaves open, which heading and where to go when
    none is left, is answered by a short tour through the few places that together show what is still to be
    seen; ``rank: gain`` takes the place of greatest gain · exp(−λ travel) instead (González-Baños & Latombe,
    2002). The present goal is kept unless another tour is clearly better.
    SUCCESS with the place in ``goal``; FAILURE once nothing of use is left in reach, with what stays open and
    why in ``left_open``.
    """

    type_key = "find_view"

    rank: Input[str] = Input(
        Literal["tour", "gain"], default="tour", doc="a tour through all, or the best by itself"
    )
    min_gain: Input[float] = Input(Area, default=0.1, ge=0.01, doc="new area that is worth a drive")
    depth: Input[float] = Input(
        Length, default=1.5, ge=0.1, doc="how far into the unknown an opening is believed"
    )
    stride: Input[float] = Input(Length, default=1.5, ge=0.1, doc="d̃: distance to a safe heading's waypoint")
    detection_range: Input[float] = Input(
        Length, default=1.2, ge=0.1, doc="l: a return nearer than this bounds a sector"
    )
    half_plane_cost: Input[float] = Input(
        Length, default=0.5, ge=0.0, doc="what it costs to turn back behind the last waypoint"
    )
    turn_cost: Input[float] = Input(Length, default=0.6, ge=0.0, doc="what turning round costs")
    keep: Input[float] = Input(
        Length, default=1.0, ge=0.0, doc="how much shorter a tour has to be to give up the present goal"
    )
    haste: Input[float] = Input(
        float, default=3.0, ge=0.0, doc="0: the shortest tour; more: what shows much comes early"
    )
    scrap_weight: Input[float] = Input(
        float, default=1.0, ge=0.0, doc="what the least view weighs in that, beside its area up to 3 m²"
    )
    leave: Input[float] = Input(
        float,
        default=0.0,
        ge=0.0,
        le=0.1,
        doc="share of the known floor that may be left unseen in scraps of less than 0.5 m²",
    )
    decay: Input[float] = Input(float, default=0.2, ge=0.0, doc="λ of rank gain, per metre")
    history: Input[HalfPlaneHistory] = Input(
        HalfPlaneHistory,
        default=Key("half_planes"),
        initial=HalfPlaneHistory(),
        doc="the half-planes of the waypoints",
    )
    goal: Output[Waypoint] = Output(Waypoint, default=Key("goal"), doc="the place")
    given_up: Output[tuple[GivenUp, ...]] = Output(
        tuple, default=Key("given_up"), doc="places not to try again"
    )
    left_open: Output[tuple[str, ...]] = Output(
        tuple, default=Key("left_open"), doc="what was not explored and why, one sentence each"
    )
    reason: Output[str] = Output(str, default=Key("reason"), doc="why the exploration is over")

    def update(self) -> Status:
        """The best of the thinned places; where those show nothing of all places, at last of tight ones."""
        self._note_look_in_vain()
        least_m = self.robot.least_margin_m
        passes = ((_MARGIN_M, False), (_MARGIN_M, True), (max(least_m, 0.0), True), (least_m, True))
        for margin_m, is_dense in dict.fromkeys(passes):
            for _ in range(_TRIES):
                chosen = self._choose(margin_m, is_dense)
                if self._is_too_little(chosen):
                    break
                view = self._best(chosen)
                if math.dist(view.xy, self._here.xy) > _HERE_M:
                    return self._take(view, len(chosen.views))
                self._give_up(view.xy, view.gain_m2)
        return self._conclude(chosen)

    @property
    def _outlooks(self) -> Outlooks:
        """What places see, kept for as long as the leaf lives."""
        if not hasattr(self, "_seen"):
            self._seen = Outlooks()
        return self._seen

    @property
    def _here(self) -> Pose2:
        return self.robot.estimate().T_map_base

    @property
    def _taste(self) -> TourTaste:
        return TourTaste(
            self.min_gain, self.depth, keep_m=self.keep, haste=self.haste, scrap_weight=self.scrap_weight
        )

    def _choose(self, margin_m: float, is_dense: bool) -> ViewSet:
        view, here = self.robot.view(), self._here
        radius_m = self.robot.footprint_radius_m + margin_m
        at = np.array([view.grid.cell_of(*here.xy)])
        travel_m = travel_field(view.clearance_m, at, radius_m, view.grid.resolution_m)
        keep_xy = self._present_goal
        places = ViewPlaces(
            view.grid,
            view.clearance_m,
            travel_m,
            radius_m=radius_m,
            is_dense=is_dense,
            more=np.array([*self._safe_waypoints(), *([keep_xy] if keep_xy else [])]).reshape(-1, 2),
            tried=np.array([place.position for place in self._tried()]).reshape(-1, 2),
        )
        return choose_views(places, self._outlooks, here.xy, self.robot.lidar_range_m, self._taste, keep_xy)

    @property
    def _present_goal(self) -> tuple[float, float] | None:
        goal: Waypoint | None = self.recall("goal", None)
        return None if goal is None else goal.position

    def _is_too_little(self, chosen: ViewSet) -> bool:
        """Whether nothing is to be seen, or only scraps that together are not worth the way."""
        grid = self.robot.view().grid
        floor_m2 = float(np.count_nonzero(grid.free)) * grid.resolution_m**2
        largest_m2 = max((view.gain_m2 for view in chosen.views), default=0.0)
        return not chosen.views or (largest_m2 < _SCRAP_M2 and chosen.total_m2 < self.leave * floor_m2)

    def _best(self, chosen: ViewSet) -> View:
        if self.rank == "gain":
            return max(chosen.views, key=self._utility)
        return order_views(chosen, self._first_leg_m, self._taste, self._present_goal)[0]

    def _safe_waypoints(self) -> list[tuple[float, float]]:
        """Steps 1 to 3 of the paper: a waypoint along the middle of every free sector, the safest first."""
        scan = self.robot.scan()
        if scan is None:
            return []
        sectors = find_free_sectors(
            scan,
            detection_range_m=self.detection_range,
            footprint_radius_m=self.robot.footprint_radius_m,
            margin_m=_MARGIN_M,
        )
        return [
            next_waypoint(self._here, sector, self.stride).position for sector in order_by_safety(sectors)
        ]

    def _first_leg_m(self, view: View) -> float:
        """What the paper's rules have against going there next, as metres."""
        here = self._here
        bearing = math.atan2(view.xy[1] - here.y, view.xy[0] - here.x)
        turn = self.turn_cost * 0.5 * (1.0 - math.cos(wrap_angle(bearing - here.yaw_rad)))
        behind = not self.history.contains(view.xy, 1)
        return turn + (self.half_plane_cost if behind else 0.0)

    def _utility(self, view: View) -> float:
        return view.gain_m2 * math.exp(-self.decay * view.travel_m)

    def _take(self, view: View, count: int) -> Status:
        (x, y), here = view.xy, self._here
        pose = Pose2(x, y, math.atan2(y - here.y, x - here.x))
        self.goal = Waypoint(pose, "view", view.gain_m2)
        self.say(
            f"{count} view{'' if count == 1 else 's'} to go; "
            f"→ ({x:.1f}, {y:.1f}), {view.travel_m:.1f} m away, {view.gain_m2:.1f} m² to see"
        )
        return Status.SUCCESS

    def _note_look_in_vain(self) -> None:
        """The goal was come to and still shows as much as it did: once left, it would call the robot back."""
        goal: Waypoint | None = self.recall("goal", None)
        if goal is None or math.dist(goal.position, self._here.xy) > _HERE_M:
            return
        grid, range_m = self.robot.view().grid, self.robot.lidar_range_m
        area_m2 = visible_unknown_area(grid, goal.position, range_m, depth_m=self.depth)
        if area_m2 >= self.min_gain:
            self._give_up(goal.position, area_m2)

    def _give_up(self, place: tuple[float, float], area_m2: float) -> None:
        reason = f"still {area_m2:.1f} m² unknown after looking from here"
        self.given_up = (*self._tried(), GivenUp(place, reason, was_seen=True))

    def _tried(self) -> tuple[GivenUp, ...]:
        return self.recall("given_up", ())

    def _conclude(self, chosen: ViewSet) -> Status:
        view = self.robot.view()
        radius_m = self.robot.footprint_radius_m
        at: NDArray[np.int64] = np.array([view.grid.cell_of(*self._here.xy)])
        travel_m = travel_field(view.clearance_m, at, radius_m, view.grid.resolution_m)
        left = what_remains(view.grid, view.clearance_m, travel_m, radius_m, min_gain_m2=self.min_gain)
        failed = ((place.position, place.reason) for place in self._tried())
        scraps = ((scrap.xy, "shows too little to be worth the way") for scrap in chosen.views)
        self.left_open = sentences((*left, *failed, *scraps))
        self.reason = f"no reachable place shows {self.min_gain:.2f} m² of new area or more"
        self.say(self.reason)
        return Status.FAILURE
