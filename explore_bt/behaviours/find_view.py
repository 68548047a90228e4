"""Leaf: the place to look from next, by what the lidar will see from it."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from explore_bt.behaviours.give_up_goal import GivenUp
from explore_bt.behaviours.marks import half_plane_marks, sector_mark
from explore_bt.behaviours.search import HERE_M, Search
from explore_bt.behaviours.share import allotted, claims_of_others, free_at, workers
from explore_bt.exploration import (
    HalfPlaneHistory,
    Outlooks,
    Reach,
    TourTaste,
    View,
    ViewPlaces,
    ViewSet,
    choose_views,
    find_free_sectors,
    first_run,
    next_waypoint,
    order_by_safety,
    order_views,
    visible_unknown_area,
)
from explore_bt.tree import Input, Key, Status
from explore_bt.types import Drawing, Pose2, Verdict, ViewMark, Waypoint, wrap_angle
from explore_bt.units import Length

__all__ = ["FindView"]

_MARGIN_M = 0.02
_TRIES = 20
_SCRAP_M2 = 0.5
_TOO_LITTLE = "shows too little to be worth the way"
_ROOM_M = 3.0
"""So far around the robot all places count: coming back for a scrap costs more than to see it now."""


class FindView(Search):
    """Picks the next place to look from among the safe headings' waypoints and the skeleton's places.

    The paper's rules go on: headings into free sectors give waypoints (1–3), the half-plane of the last
    waypoint makes turning back cost (4), a place looked from in vain is not visited again (5), and every
    place counts by the new area in view (6). What the paper leaves open, which heading and where to go when
    none is left, is answered by a short tour through the few places that together show what is still to be
    seen, led by the one of greatest gain · exp(−λ travel) (González-Baños & Latombe, 2002); ``rank: gain``
    takes that one alone. Views that lie one behind another are one run: its last is the goal, the others are
    passed on the way (``detour``). A run is kept unless another tour is clearly better.
    In a team, what others have claimed is as good as seen; the mission's allocator divides the rest.
    SUCCESS with the place in ``goal``; FAILURE once nothing of use is left in reach, or nothing that is this
    robot's, with what stays open and why in ``left_open``.
    """

    type_key = "find_view"

    rank: Input[str] = Input(
        Literal["tour", "gain"], default="tour", doc="a tour through all, or the best by itself"
    )
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
    detour: Input[float] = Input(
        Length, default=2.0, ge=0.0, doc="what passing places may add to the way before one is a goal itself"
    )
    aside: Input[float] = Input(
        Length, default=2.0, ge=0.0, doc="what they may add to the way to the most promising place"
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
    decay: Input[float] = Input(
        float, default=0.2, ge=0.0, doc="λ: how fast area loses worth with the way, 1/m"
    )
    history: Input[HalfPlaneHistory] = Input(
        HalfPlaneHistory,
        default=Key("half_planes"),
        initial=HalfPlaneHistory(),
        doc="the half-planes of the waypoints",
    )

    def update(self) -> Status:
        """The best place; far off thinned ones while those show any, and tight ones at last."""
        self._left_to_others = 0
        self._note_look_in_vain()
        least_m = self.robot.least_margin_m
        more = self._further_places()
        passes = (
            (_MARGIN_M, _ROOM_M),
            (_MARGIN_M, math.inf),
            (max(least_m, 0.0), math.inf),
            (least_m, math.inf),
        )
        reaches: dict[float, Reach] = {}
        for margin_m, dense_m in dict.fromkeys(passes):
            if margin_m not in reaches:
                reaches[margin_m] = self._reach(margin_m)
            places = ViewPlaces(reaches[margin_m], dense_m=dense_m, more=more)
            for _ in range(_TRIES):
                chosen = self._choose(places)
                if self._is_too_little(chosen):
                    break
                run = self._best_run(chosen)
                if math.dist(run[0].xy, self.here().xy) > HERE_M:
                    return self._take(run, chosen.views)
                self._give_up_look(run[0].xy, run[0].gain_m2)
        self._draw_views((), chosen.views)
        scraps = ((view.xy, _TOO_LITTLE) for view in chosen.views)
        self.robot.team.claim(())
        reason = f"no reachable place shows {self.min_gain:.2f} m² of new area or more"
        if self._left_to_others:
            reason = f"what is left is left to others: {self._left_to_others} views"
        return self.conclude(reason, (*self._still_unseen(), *scraps))

    @property
    def _outlooks(self) -> Outlooks:
        """What places see, kept for as long as the leaf lives."""
        if not hasattr(self, "_seen"):
            self._seen = Outlooks()
        return self._seen

    @property
    def _taste(self) -> TourTaste:
        return TourTaste(
            self.min_gain,
            self.depth,
            keep_m=self.keep,
            haste=self.haste,
            scrap_weight=self.scrap_weight,
            decay_per_m=self.decay,
            aside_m=self.aside,
        )

    def _further_places(self) -> NDArray[np.float64]:
        """(N, 2) the safe headings' waypoints and the present run."""
        return np.vstack((np.array(self._safe_waypoints()).reshape(-1, 2), self._present_run))

    def _reach(self, margin_m: float) -> Reach:
        view = self.robot.view()
        return Reach(view.ground, view.clearance_m, self.here().xy, self.robot.footprint_radius_m + margin_m)

    def _choose(self, places: ViewPlaces) -> ViewSet:
        tried = np.array([place.position for place in self.tried()]).reshape(-1, 2)
        places = places.without(tried)
        about = (places, self._outlooks, self.robot.lidar_range_m, self._taste, self._present_run)
        mates = workers(self.robot)
        begin = np.array([free_at(mate) for mate in mates]).reshape(-1, 2)
        chosen = choose_views(*about, claims_of_others(self.robot, self._present_run), begin)
        if not mates or not chosen.views:
            return chosen
        kept = np.array([self._is_kept(view) for view in chosen.views])
        gains = [view.gain_m2 for view in chosen.views]
        mine = allotted(self.robot, mates, gains, chosen.between_m, chosen.from_others_m, kept)
        self._left_to_others = len(gains) - len(mine)
        return chosen.only(mine)

    def _is_kept(self, view: View) -> bool:
        run = self._present_run
        return bool(len(run)) and bool((np.hypot(*(run - view.xy).T) < HERE_M).any())

    @property
    def _present_run(self) -> NDArray[np.float64]:
        """(K, 2) metres: the places to pass and, last, the goal; none before the first."""
        goal: Waypoint | None = self.recall("goal", None)
        return np.array([] if goal is None else [*goal.via, goal.position]).reshape(-1, 2)

    def _is_too_little(self, chosen: ViewSet) -> bool:
        """Whether nothing is to be seen, or only scraps that together are not worth the way."""
        grid = self.robot.view().grid
        floor_m2 = float(np.count_nonzero(grid.free)) * grid.resolution_m**2
        largest_m2 = max((view.gain_m2 for view in chosen.views), default=0.0)
        return not chosen.views or (largest_m2 < _SCRAP_M2 and chosen.total_m2 < self.leave * floor_m2)

    def _best_run(self, chosen: ViewSet) -> tuple[View, ...]:
        if self.rank == "gain":
            return (max(chosen.views, key=lambda view: view.worth(self.decay)),)
        present = self._present_run
        order = order_views(chosen, self._first_leg_m, self._taste, present)
        end = tuple(present[-1].tolist()) if len(present) else None
        return first_run(chosen, order, self.detour, end)

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
        marks = (sector_mark(self.here(), sector, self.detection_range) for sector in sectors)
        self.robot.draw(Drawing(tuple(marks), half_plane_marks(self.history.last(1))))
        return [
            next_waypoint(self.here(), sector, self.stride).position for sector in order_by_safety(sectors)
        ]

    def _first_leg_m(self, view: View) -> float:
        """What the paper's rules have against going there next, as metres."""
        here = self.here()
        bearing = math.atan2(view.xy[1] - here.y, view.xy[0] - here.x)
        turn = self.turn_cost * 0.5 * (1.0 - math.cos(wrap_angle(bearing - here.yaw_rad)))
        behind = not self.history.contains(view.xy, 1)
        return turn + (self.half_plane_cost if behind else 0.0)

    def _take(self, run: tuple[View, ...], views: tuple[View, ...]) -> Status:
        *passed, last = run
        (x, y), before = last.xy, passed[-1].xy if passed else self.here().xy
        pose = Pose2(x, y, math.atan2(y - before[1], x - before[0]))
        self.goal = Waypoint(pose, "view", last.gain_m2, via=tuple(view.xy for view in passed))
        self.robot.team.claim([view.xy for view in run])
        self._draw_views(run, views)
        over = f" over {len(passed)} other{'' if len(passed) == 1 else 's'}" if passed else ""
        self.say(
            f"{len(views)} view{'' if len(views) == 1 else 's'} to go; → ({x:.1f}, {y:.1f}){over}, "
            f"{last.travel_m:.1f} m away, {sum(view.gain_m2 for view in run):.1f} m² to see"
        )
        return Status.SUCCESS

    def _draw_views(self, run: tuple[View, ...], views: Iterable[View]) -> None:
        """The goal, what is passed on the way to it, the other views, and the places given up."""
        marks = [self._view_mark(view, Verdict.TAKEN, "the next goal") for view in run[-1:]]
        marks += [self._view_mark(view, Verdict.TAKEN, "passed on the way") for view in run[:-1]]
        rest = (Verdict.OPEN, "") if run else (Verdict.REJECTED, _TOO_LITTLE)
        marks += [self._view_mark(view, *rest) for view in views if view not in run]
        for place in reversed(self.tried()):
            x, y = place.position
            marks.append(ViewMark(x, y, 0.0, place.gain_m2, Verdict.REJECTED, place.reason))
        self.robot.draw(Drawing(views=tuple(marks)))

    def _view_mark(self, view: View, state: Verdict, reason: str) -> ViewMark:
        (x, y), here = view.xy, self.here()
        return ViewMark(x, y, math.atan2(y - here.y, x - here.x), view.gain_m2, state, reason)

    def _note_look_in_vain(self) -> None:
        """The goal was come to and still shows enough for one: once left, it would call the robot back."""
        for x, y in self._present_run.tolist():
            if math.dist((x, y), self.here().xy) > HERE_M:
                continue
            area_m2 = self._area_m2((x, y))
            if area_m2 >= self.min_gain:
                self._give_up_look((x, y), area_m2)

    def _give_up_look(self, place: tuple[float, float], area_m2: float) -> None:
        self.give_up(GivenUp(place, f"still {area_m2:.1f} m² unknown after looking from here", was_seen=True))

    def _still_unseen(self) -> Iterator[tuple[tuple[float, float], str]]:
        """Places given up that would still show something; what others showed since is no loss."""
        for place in self.tried():
            if self._area_m2(place.position) >= self.min_gain:
                yield place.position, place.reason

    def _area_m2(self, place: tuple[float, float]) -> float:
        blocks, range_m = self.robot.view().ground.grid, self.robot.lidar_range_m
        return visible_unknown_area(blocks, place, range_m, depth_m=self.depth)
