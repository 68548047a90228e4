"""Leaf: the paper's FindNextHeading."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from explore_bt.behaviours.give_up_goal import GivenUp
from explore_bt.behaviours.marks import half_plane_marks, sector_mark
from explore_bt.behaviours.share import claims_of_others
from explore_bt.exploration import (
    FreeSector,
    HalfPlaneHistory,
    clearance_at,
    find_free_sectors,
    next_waypoint,
    repeated_visit,
    visible_unknown_area,
)
from explore_bt.tree import Input, Key, Leaf, Output, Status
from explore_bt.types import Drawing, Pose2, Scan2D, Verdict, Waypoint, wrap_angle
from explore_bt.units import Area, Length

__all__ = ["FindNextHeading"]

_GIVEN_UP_RADIUS_M = 0.5
_STRIDES = 3
_DEPTH_M = 1.0  # how far into the unknown an opening is believed


class FindNextHeading(Leaf):
    """Takes the safest heading ahead that stays in the half-planes, is not a revisit, and shows new area.

    SUCCESS with the next waypoint in ``goal``; FAILURE when no heading qualifies. Its words list every
    heading looked at and why it was refused.
    Source: Algorithm 1 (FindNextHeading) and equations 1–3 of the paper.
    """

    type_key = "find_next_heading"

    half_planes: Input[int | str] = Input(
        Annotated[int, Field(ge=1)] | Literal["all"],
        default="all",
        doc="L: how many of the last half-planes constrain the waypoint; the paper takes all since the reset",
    )
    stride: Input[float] = Input(Length, default=1.5, ge=0.1, doc="d̃: distance to the next waypoint")
    min_stride: Input[float | None] = Input(
        Length | None, default=None, doc="try shorter strides down to this before refusing; literal without"
    )
    detection_range: Input[float] = Input(
        Length, default=1.2, ge=0.1, doc="l: a return nearer than this bounds a sector"
    )
    revisit: Input[bool] = Input(bool, default=True, doc="whether revisit suppression is on")
    revisit_cosine: Input[float] = Input(
        float, default=0.5, ge=-1.0, le=1.0, doc="a^r: largest heading product that still counts as different"
    )
    min_gain: Input[float] = Input(
        Area, default=0.3, ge=0.0, doc="new area that must be expected at the waypoint"
    )
    margin: Input[float] = Input(Length, default=0.02, ge=0.0, doc="free space beyond the footprint")
    look: Input[str] = Input(
        Literal["ahead", "behind"], default="ahead", doc="which semicircle; behind turns on the way"
    )
    bridge_beams: Input[int] = Input(
        int, default=2, ge=0, doc="drop-outs in a row that do not split a sector; 0 is literal"
    )
    visited: Input[tuple[Waypoint, ...]] = Input(
        tuple, default=Key("visited"), initial=(), doc="P: the waypoints so far"
    )
    history: Input[HalfPlaneHistory] = Input(
        HalfPlaneHistory,
        default=Key("half_planes"),
        initial=HalfPlaneHistory(),
        doc="the half-planes since the last reset",
    )
    given_up: Input[tuple[GivenUp, ...]] = Input(
        tuple, default=Key("given_up"), initial=(), doc="places not to try again"
    )
    goal: Output[Waypoint] = Output(Waypoint, default=Key("goal"), doc="p^{k+1} and its heading")

    def update(self) -> Status:
        """Try the headings in descending order of safety, take the first that passes."""
        scan = self.robot.scan()
        if scan is None:
            self.say("no scan yet")
            return Status.FAILURE
        pose = self.robot.estimate().T_map_base
        looks = self._looks(pose, self._sectors(scan))
        self._draw(pose, looks)
        self.say("; ".join((_count(len(looks)), *(look.words for look in looks if look.words))))
        goal = next((look.goal for look in looks if look.goal is not None), None)
        if goal is None:
            return Status.FAILURE
        self.goal = goal
        self.robot.team.claim([goal.position])
        return Status.SUCCESS

    def _looks(self, pose: Pose2, sectors: Iterable[FreeSector]) -> list[_Look]:
        """Each sector with what was decided about it; those after the one that was taken stay open."""
        looks: list[_Look] = []
        is_decided = False
        for sector in sectors:
            looks.append(_Look(sector) if is_decided else self._look_along(pose, sector))
            is_decided |= looks[-1].verdict is Verdict.TAKEN
        return looks

    def _look_along(self, pose: Pose2, sector: FreeSector) -> _Look:
        """The longest stride that qualifies, else why the shortest one doesn't."""
        for stride in self._strides():
            there = next_waypoint(pose, sector, stride).pose
            refusal, gain_m2 = self._judge(there)
            if not refusal:
                reason = f"→ ({there.x:.1f}, {there.y:.1f}), {gain_m2:.1f} m² to see"
                return _Look(sector, Verdict.TAKEN, reason, Waypoint(there, "safe heading", gain_m2))
        return _Look(sector, Verdict.REJECTED, refusal)

    def _draw(self, pose: Pose2, looks: Iterable[_Look]) -> None:
        range_m = self.detection_range
        marks = (sector_mark(pose, look.sector, range_m, look.verdict, look.reason) for look in looks)
        planes = self.history.last(self._window)
        self.robot.draw(Drawing(sectors=tuple(marks), half_planes=half_plane_marks(planes)))

    def _sectors(self, scan: Scan2D) -> tuple[FreeSector, ...]:
        return find_free_sectors(
            scan,
            detection_range_m=self.detection_range,
            footprint_radius_m=self.robot.footprint_radius_m,
            margin_m=self.margin,
            facing_rad=0.0 if self.look == "ahead" else math.pi,
            bridge_beams=self.bridge_beams,
        )

    def _strides(self) -> list[float]:
        shortest = self.stride if self.min_stride is None else min(self.min_stride, self.stride)
        count = 1 if shortest == self.stride else _STRIDES
        return [float(stride) for stride in np.linspace(self.stride, shortest, count)]

    def _judge(self, pose: Pose2) -> tuple[str, float]:
        """Why a waypoint does not qualify (empty if it does), and the new area to be seen from it, m²."""
        refusal = self._refusal(pose)
        if refusal:
            return refusal, 0.0
        grid = self.robot.view().grid
        gain_m2 = visible_unknown_area(grid, pose.xy, self.robot.lidar_range_m, depth_m=_DEPTH_M)
        return (f"shows only {gain_m2:.2f} m² of new area" if gain_m2 < self.min_gain else ""), gain_m2

    def _refusal(self, pose: Pose2) -> str:
        """Which of the rules about place and direction a waypoint breaks; empty if none."""
        plane = self.history.broken_by(pose.xy, self._window)
        if plane is not None:
            (x, y), behind_m = plane.position, -plane.ahead_m(pose.xy)
            return f"outside the half-planes: {behind_m:.2f} m behind that of ({x:.1f}, {y:.1f})"
        if self.revisit and (words := self._revisit(pose)):
            return words
        for place in self.given_up:
            if (away_m := math.dist(place.position, pose.xy)) < _GIVEN_UP_RADIUS_M:
                return f"{away_m:.2f} m from a place given up before: {place.reason}"
        for x, y in claims_of_others(self.robot, np.array([pose.xy])).tolist():
            if (away_m := math.dist((x, y), pose.xy)) < self.detection_range:
                return f"{away_m:.2f} m from where another robot goes"
        grid = self.robot.view().grid
        needed_m = self.robot.footprint_radius_m + self.margin
        clearance_m = float(clearance_at(grid, np.array([pose.xy]), needed_m)[0])
        if clearance_m < needed_m:
            return f"only {clearance_m:.2f} m clear at the waypoint, needs {needed_m:.2f} m"
        return ""

    @property
    def _window(self) -> int | None:
        return None if self.half_planes == "all" else int(self.half_planes)

    def _revisit(self, pose: Pose2) -> str:
        """Which waypoint was visited before and left in the same direction; empty if none."""
        poses = [waypoint.pose for waypoint in self.visited]
        before = repeated_visit(pose, poses, self.detection_range, self.revisit_cosine)
        if before is None:
            return ""
        turn = abs(math.degrees(wrap_angle(pose.yaw_rad - before.yaw_rad)))
        away_m = pose.distance_to(before)
        return f"visited, same direction: {away_m:.2f} m from waypoint {poses.index(before)}, {turn:.0f}° off"


@dataclass(frozen=True, slots=True)
class _Look:
    """A sector, and what was decided about it."""

    sector: FreeSector
    verdict: Verdict = Verdict.OPEN
    reason: str = ""
    goal: Waypoint | None = None

    @property
    def words(self) -> str:
        """Empty for one that was not looked at."""
        turn = math.degrees(wrap_angle(self.sector.bisector_rad))
        which = f"{math.degrees(self.sector.width_rad):.0f}° at {turn:+.0f}°"
        if self.verdict is Verdict.TAKEN:
            return f"took {which} {self.reason}"
        return f"{which} refused ({self.reason})" if self.verdict is Verdict.REJECTED else ""


def _count(sectors: int) -> str:
    return f"{sectors or 'no'} free sector{'' if sectors == 1 else 's'}"
