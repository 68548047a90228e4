"""Leaf: drive to a waypoint along the planner's path, and mind what the map learns on the way."""

from __future__ import annotations

import math

import numpy as np

from explore_bt.behaviours.mates import goes_before, mate_in_the_way
from explore_bt.behaviours.people import SOMEONE, someone_is_in_the_way, who_is_near
from explore_bt.behaviours.share import claimed_before
from explore_bt.errors import ComponentFailure, GoalBlocked, NoPath, PlanningFailure, StartBlocked
from explore_bt.exploration import clearance_at, visible_unknown_area
from explore_bt.interfaces import ControlStatus, HeldBy
from explore_bt.tree import Input, Key, Leaf, Output, Status
from explore_bt.types import Mate, Path, Pose2, Waypoint, way_along
from explore_bt.units import Area, Duration, Length

__all__ = ["DriveTo"]

_LOOK_PERIOD_S = 1.0
_WATCHED_M = 4.0
_TIGHT_POSES_AHEAD = 2  # about 0.2 m: the gate's brake ends before the place itself
_NOTHING_M2 = 0.02
_DETOUR_M = 5.0
_PASSED_M = 0.2
_BESIDE_M = 1.0
_MATE_S, _INSISTS_S = 1.0, 15.0
"""A mate that goes first is planned around after this; one that does not has so long to move off."""
_MOVING_MPS = 0.05
_MATE_PLANS = 3


class DriveTo(Leaf):
    """Plans a path to the goal and follows it; plans anew when the path is cut or the robot is held.

    The path goes over what is left of the goal's ``via``. SUCCESS at the goal, or as soon as nothing new is
    to be seen from it nor from a place still to be passed, or a team mate that goes first is on its way
    there too (``until_seen``), or after some way (``look_again``; then also where the way is cut and the one
    around is 5 m longer). A goal that promises less than ``until_seen`` is a scrap: once begun it is driven
    to, or until nothing of it is left, for deciding anew would only trade it for the next scrap.
    A team mate in the way is waited for, or planned around; where there is no way around and it goes first,
    that is a FAILURE ``someone_in_the_way``: see ``make_way``. Someone unknown in the way is waited for,
    without a new plan, for what is free now is not free in a second; after a while (``give_way``) that is
    such a FAILURE too.
    FAILURE when no path is left; the planner's typed reason goes to ``failure``.
    """

    type_key = "drive_to"

    goal: Input[Waypoint] = Input(Waypoint, default=Key("goal"), doc="where to")
    until_seen: Input[float] = Input(
        Area,
        default=0.0,
        ge=0.0,
        doc="stop early once less new area than this is expected at the goal; 0 always drives to the end",
    )
    depth: Input[float | None] = Input(
        Length | None,
        default=None,
        doc="how far into the unknown an opening is believed when asking what is to be seen",
    )
    look_again: Input[float | None] = Input(
        Length | None, default=None, doc="stop early after so much way, to decide anew"
    )
    patience: Input[float] = Input(
        Duration, default=2.0, ge=0.0, doc="how long the safety gate may hold the robot before a new plan"
    )
    replans: Input[int] = Input(int, default=3, ge=0, doc="new plans after being held, before giving up")
    give_way: Input[float] = Input(
        Duration, default=3.0, ge=0.0, doc="how long to wait for someone in the way before the tree is asked"
    )
    failure: Output[str] = Output(str, default=Key("failure"), doc="code of the reason for a failure")
    reached: Output[Waypoint] = Output(
        Waypoint, default=Key("reached"), doc="the goal; where it was seen from, if the drive stopped early"
    )

    _left: tuple[float, float] | None = None

    def initialise(self) -> None:
        """A new drive begins."""
        self._path: Path | None = None
        self._via = list(self.goal.via)
        self._held = self._mate_plans = 0
        self._checked_revision = -1
        self._cut = ""
        self._begun_m = self.robot.distance_m
        self._next_look_s = self.robot.now_s() + _LOOK_PERIOD_S
        self._next_plan_s = 0.0
        self._without_path_s: float | None = None

    def update(self) -> Status:
        """Plan when there is no path, else watch the one being followed."""
        if self._path is None:
            return self._plan() if self.robot.now_s() >= self._next_plan_s else Status.RUNNING
        self._note_passed()
        if self._is_seen():
            return self._stop_here("seen from here", self.feedback_message)
        output = self.robot.pilot.output
        if (held := self._held_by_mate()) is not None:
            return held
        if output.status is ControlStatus.ARRIVED:
            self.reached = self.goal
            away_m = self.robot.estimate().T_map_base.distance_to(self.goal.pose)
            self.say(f"arrived, {100.0 * away_m:.0f} cm from the goal")
            return Status.SUCCESS
        if output.status is ControlStatus.STUCK or self.robot.pilot.blocked_s > self.patience:
            if someone_is_in_the_way(self.robot):
                if output.status is ControlStatus.STUCK:
                    self.robot.pilot.follow(self._path)  # they go on, and so may it at any moment
                return self._wait_for_someone(self.robot.pilot.blocked_s)
            return self._plan_after_hold(output.reason)
        if self._is_cut():
            return self._plan_around()
        driven_m = self.robot.distance_m - self._begun_m
        if self.look_again is not None and driven_m >= self.look_again and not self._is_scrap:
            return self._stop_here("on the way", f"{driven_m:.1f} m driven, time to decide anew")
        return Status.RUNNING

    def _stop_here(self, reason: str, words: str) -> Status:
        self.reached = Waypoint(self.robot.estimate().T_map_base, reason)
        self.say(words)
        return Status.SUCCESS

    def terminate(self, new_status: Status) -> None:
        """Whoever cuts the drive off, or finds no way on, leaves a robot that comes to rest."""
        if new_status is not Status.SUCCESS:
            self.robot.pilot.hold()

    def _plan(self, why: str = "") -> Status:
        """A path to the goal, and why there has to be another one."""
        goal = self.goal
        try:
            self._path = self.robot.plan(goal.pose, self._via)
        except (PlanningFailure, ComponentFailure) as refusal:
            if self._may_be_people(refusal):
                return self._wait_without_path()
            self.failure = refusal.code if isinstance(refusal, PlanningFailure) else "planner_failed"
            self.say("; ".join(filter(None, (f"no path: {refusal}", why))))
            return Status.FAILURE
        self._without_path_s = None
        self.robot.pilot.follow(self._path)
        x, y = goal.position
        length_m, closest_m = self._path.length_m, self._path.min_clearance_m
        words = f"to ({x:.1f}, {y:.1f}): {length_m:.1f} m, closest {closest_m:.2f} m"
        self.say("; ".join(filter(None, (words, why))))
        return Status.RUNNING

    def _may_be_people(self, refusal: Exception) -> bool:
        """Whether someone may stand in the only way, or on the goal."""
        if isinstance(refusal, NoPath | GoalBlocked) and mate_in_the_way(self.robot) is not None:
            return True
        if isinstance(refusal, GoalBlocked):
            return bool(who_is_near(self.robot, self.goal.pose, _BESIDE_M))
        return bool(self.robot.moving) and isinstance(refusal, NoPath | StartBlocked)

    def _wait_without_path(self) -> Status:
        """Whoever walks about may stand in the only way: ask again in a second."""
        now_s = self.robot.now_s()
        if self._without_path_s is None:
            self._without_path_s = now_s
            self.robot.pilot.hold()
        self._next_plan_s = now_s + _LOOK_PERIOD_S
        self._path = None
        return self._wait_for_someone(now_s - self._without_path_s)

    def _wait_for_someone(self, waited_s: float) -> Status:
        if waited_s > self.give_way:
            self.failure = SOMEONE
            self.say(f"someone has been in the way for {waited_s:.0f} s")
            return Status.FAILURE
        self.say(f"waiting for someone to pass, up to {self.give_way:.0f} s")
        return Status.RUNNING

    def _held_by_mate(self) -> Status | None:
        """What to do about a team mate in the way; None if there is none, or it may still move off."""
        pilot = self.robot.pilot
        is_stuck = pilot.output.status is ControlStatus.STUCK
        if not is_stuck and pilot.blocked_s <= _MATE_S:
            return None
        mate = mate_in_the_way(self.robot)
        if mate is None:
            return None
        self.say(f"waiting for {mate.name}")
        if mate.is_parked or goes_before(self.robot, mate):
            is_moving = abs(mate.twist.linear_mps) > _MOVING_MPS and pilot.blocked_s < self.give_way
            return Status.RUNNING if is_moving else self._plan_around_mate(mate)
        if pilot.blocked_s > _INSISTS_S:
            return self._give_way_to(mate)
        if is_stuck:
            return self._plan(why=f"again, {mate.name} was in the way")
        return Status.RUNNING

    def _plan_around_mate(self, mate: Mate) -> Status:
        self._mate_plans += 1
        if self._mate_plans > _MATE_PLANS:
            return self._give_way_to(mate)
        try:
            self._path = self.robot.plan(self.goal.pose, self._via)
        except (PlanningFailure, ComponentFailure):
            return self._give_way_to(mate)
        self.robot.pilot.follow(self._path)
        self.say(f"around {mate.name}: {self._path.length_m:.1f} m")
        return Status.RUNNING

    def _give_way_to(self, mate: Mate) -> Status:
        self.failure = SOMEONE
        self.say(f"{mate.name} is in the way")
        return Status.FAILURE

    def _note_passed(self) -> None:
        here = self.robot.estimate().T_map_base.xy
        if self._via and math.dist(self._via[0], here) <= _PASSED_M:
            del self._via[0]

    def _plan_around(self) -> Status:
        """Another plan; where it has become a detour the tree decides anew, if that is asked for."""
        left_m = self._left_m()
        status = self._plan(why=f"the way was cut: {self._cut}")
        if status is not Status.RUNNING or self._path is None or self.look_again is None:
            return status
        more_m = self._path.length_m - left_m
        if more_m <= _DETOUR_M:
            return status
        return self._stop_here("before a detour", f"{self._cut}; the way around is {more_m:.1f} m longer")

    def _left_m(self) -> float:
        assert self._path is not None
        nearest = _nearest_pose(self._path, self.robot.estimate().T_map_base)
        return float(way_along(self._path.poses[nearest:])[-1])

    def _plan_after_hold(self, reason: str) -> Status:
        """Another plan; from the second hold on without the place ahead, which is then too tight."""
        self._held += 1
        reason = reason or self.robot.pilot.gate_reason
        if self._held > self.replans:
            self.failure = "held"
            self.say(f"gave up after {self._held} holds: {reason}")
            return Status.FAILURE
        if self._held > 1 and self.robot.pilot.held_by is HeldBy.OBSTACLE:
            self.robot.avoid(self._place_ahead())
        return self._plan(why=f"plan {self._held} of {self.replans} after being held: {reason}")

    def _place_ahead(self) -> tuple[float, float]:
        assert self._path is not None
        ahead = _ahead(self._path, self.robot.estimate().T_map_base)
        x, y = ahead[min(_TIGHT_POSES_AHEAD, len(ahead) - 1), :2]
        return (float(x), float(y))

    def _is_cut(self) -> bool:
        """Whether the way ahead has become too tight in the newest map."""
        assert self._path is not None
        grid = self.robot.view().grid
        if grid.revision == self._checked_revision:
            return False
        self._checked_revision = grid.revision
        here = self.robot.estimate().T_map_base
        ahead = _ahead(self._path, here)
        radius = self.robot.footprint_radius_m
        needed_m = min(radius, float(ahead[:, 2].min()))
        clear_m = float(clearance_at(grid, ahead[:, :2], radius).min())
        self._cut = f"only {clear_m:.2f} m clear ahead, needs {needed_m:.2f} m"
        return clear_m < needed_m

    @property
    def _is_scrap(self) -> bool:
        return 0.0 < self.goal.expected_gain_m2 < self.until_seen

    def _is_seen(self) -> bool:
        if self.until_seen <= 0.0 or self.robot.now_s() < self._next_look_s:
            return False
        self._next_look_s = self.robot.now_s() + _LOOK_PERIOD_S
        if self._is_left_to_mate():
            return True
        enough_m2 = _NOTHING_M2 if self._is_scrap else self.until_seen
        most_m2 = 0.0
        for place in (self.goal.position, *self._via):
            most_m2 = max(most_m2, self._area_m2(place))
            if most_m2 >= enough_m2:
                return False
        self.say(f"seen from afar: only {most_m2:.2f} m² would be new")
        return True

    def _is_left_to_mate(self) -> bool:
        """Once for a goal: chosen again it shows what the mate's place does not."""
        place = self.goal.position
        mate = claimed_before(self.robot, place)
        if not mate or place == self._left:
            return False
        self._left = place
        self.say(f"left to {mate}, which is on its way there too")
        return True

    def _area_m2(self, place: tuple[float, float]) -> float:
        return visible_unknown_area(
            self.robot.view().ground.grid,
            place,
            self.robot.lidar_range_m,
            depth_m=math.inf if self.depth is None else self.depth,
        )


def _nearest_pose(path: Path, here: Pose2) -> int:
    offsets = path.poses[:, :2] - np.array(here.xy)
    return int(np.argmin(np.einsum("ij,ij->i", offsets, offsets)))


def _ahead(path: Path, here: Pose2) -> np.ndarray[tuple[int, int], np.dtype[np.float64]]:
    """(N, 3) x, y and planned clearance of the poses within the next metres from the nearest one on."""
    nearest = _nearest_pose(path, here)
    along_m = way_along(path.poses[nearest:])
    watched = slice(nearest, nearest + int(np.searchsorted(along_m, _WATCHED_M, side="right")))
    return np.column_stack((path.poses[watched, :2], path.clearance_m[watched]))
