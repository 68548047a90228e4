"""Leaf: step aside for someone who comes, and wait until the way is free."""

from __future__ import annotations

import math

import numpy as np

from explore_bt.behaviours.mates import course_of, goes_before, mate_in_the_way, needed_apart_m
from explore_bt.behaviours.people import someone_is_in_the_way, who_is_near
from explore_bt.errors import ComponentFailure, PlanningFailure
from explore_bt.exploration import find_refuge, find_sidestep, gap_to_courses_m
from explore_bt.interfaces import ControlStatus
from explore_bt.tree import Input, Key, Leaf, Status
from explore_bt.types import Mate, Pose2, Waypoint
from explore_bt.units import Duration, Length

__all__ = ["MakeWay"]

_MARGIN_M = 0.05
_APART_M = 0.3
_SAME_M = 0.3
_HERE_M = 0.1
_MATE_CHANCES = 4
_INSIST_S, _ASK_S = 30.0, 2.0
_PARKED_S = 4.0
"""A mate that has stood so long without a path is not waited for: it has arrived, or waits for this robot.
The one that goes first waits half as long, or both would go on at once."""


class MakeWay(Leaf):
    """Drives to a near place beside the courses of those who come, a side branch of a corridor, and waits.

    Where no place is better than the one it stands on it waits there. For a team mate, whose path is known,
    that is a place off that path, up to ``for_mates`` away, until it has passed or wants nothing any more;
    where there is none the robot asks for the way itself.
    SUCCESS as soon as nobody is near or comes nearer, or after ``patience``. FAILURE if nobody was in the
    way, or the same goal has been stood aside from ``chances`` times: it may be the building after all.
    """

    type_key = "make_way"

    at_most: Input[float] = Input(Length, default=3.0, ge=0.1, doc="no farther aside than this")
    clear: Input[float] = Input(
        Length, default=2.5, ge=0.0, doc="the way is free while nobody nearer than this comes on"
    )
    goal: Input[Waypoint] = Input(Waypoint, default=Key("goal"), doc="the goal that was not come to")
    chances: Input[int] = Input(int, default=5, ge=1, doc="how often for the same goal in a row")
    patience: Input[float] = Input(Duration, default=10.0, ge=0.0, doc="how long to wait at most")
    for_mates: Input[float] = Input(Length, default=15.0, ge=0.1, doc="how far aside for a team mate")
    mate_patience: Input[float] = Input(
        Duration, default=40.0, ge=0.0, doc="how long to drive aside and wait for a team mate at most"
    )

    keeps = ("_given",)

    _given: tuple[tuple[float, float], int] = ((math.nan, math.nan), 0)

    def initialise(self) -> None:
        """Look for a place."""
        self._mate = mate_in_the_way(self.robot)
        self._held_at = self.robot.estimate().T_map_base.xy
        self._parked_since_s: float | None = None
        patience_s = self.patience if self._mate is None else self.mate_patience
        self._until_s = self.robot.now_s() + patience_s
        self._makes_way = self._is_needed()
        self._is_driving = self._makes_way and (
            self._step_aside() if self._mate is None else self._leave_course(self._mate)
        )

    def update(self) -> Status:
        """Until the way is free."""
        if not self._makes_way:
            return Status.FAILURE
        if self._is_driving and self._has_come():
            self._is_driving = False
            self.robot.pilot.hold()
        if self.robot.now_s() >= self._until_s:
            self.say("has waited long enough; on")
            return Status.SUCCESS
        if not self._is_driving and self._is_free():
            self.say("the way is free")
            return Status.SUCCESS
        return Status.RUNNING

    def terminate(self, new_status: Status) -> None:  # noqa: ARG002  # the same however it ended
        """Whatever comes next begins from rest."""
        self.robot.pilot.hold()

    def _is_needed(self) -> bool:
        self.say("")  # if nobody is, this is no reason for anything
        if self._mate is None and not someone_is_in_the_way(self.robot):
            return False
        place, count = self._given
        count = count + 1 if math.dist(place, self.goal.position) < _SAME_M else 1
        self._given = (self.goal.position, count)
        if count > self.chances:
            self.say(f"has stood aside {count - 1} times for this goal")
        return count <= self.chances * (1 if self._mate is None else _MATE_CHANCES)

    def _step_aside(self) -> bool:
        view, robot = self.robot.view(), self.robot
        place = find_refuge(
            view.grid,
            view.clearance_m,
            robot.estimate().T_map_base.xy,
            robot.moving,
            robot.footprint_radius_m + _MARGIN_M,
            most_way_m=self.at_most,
        )
        if place is None:
            self.say("waiting here: no place is farther out of the way")
            return False
        return self._drive_off(place, "aside")

    def _leave_course(self, mate: Mate) -> bool:
        """Drive off its path; where no place is, ask for the way."""
        view, robot = self.robot.view(), self.robot
        here = robot.estimate().T_map_base
        course, apart_m = course_of(mate), needed_apart_m(robot, mate)
        radius_m = robot.footprint_radius_m + _MARGIN_M
        place = find_sidestep(
            view.grid, view.clearance_m, here.xy, radius_m, course, apart_m, most_way_m=self.for_mates
        )
        if place is None:
            robot.team.insist(robot.now_s() + _INSIST_S)
            self.say(f"no place off {mate.name}'s way: asks it to yield")
            self._until_s = robot.now_s() + _ASK_S
            return False
        if math.dist(place, here.xy) < _HERE_M:
            self.say(f"off {mate.name}'s way already")
            return False
        return self._drive_off(place, f"off {mate.name}'s way")

    def _drive_off(self, place: tuple[float, float], where: str) -> bool:
        """Whether there is a way to that place: the robot is on it then."""
        here = self.robot.estimate().T_map_base
        yaw = math.atan2(place[1] - here.y, place[0] - here.x)
        try:
            path = self.robot.plan(Pose2(*place, yaw))
        except (PlanningFailure, ComponentFailure) as refusal:
            self.say(f"waiting here: no way aside, {refusal}")
            return False
        self.robot.pilot.follow(path)
        self.say(f"{path.length_m:.1f} m {where}, to ({place[0]:.1f}, {place[1]:.1f})")
        return True

    def _has_passed(self, before: Mate) -> bool:
        """It is gone, or neither it nor its way comes near where the robot was held."""
        mate = next((each for each in self.robot.team.mates if each.name == before.name), None)
        if mate is None:
            return True
        if self._is_parked(mate):
            return True
        off_m = np.hypot(*(course_of(mate) - self._held_at).T).min()
        return bool(off_m > needed_apart_m(self.robot, mate) + _APART_M)

    def _is_parked(self, mate: Mate) -> bool:
        """Whether it has had nowhere to go for long."""
        now_s = self.robot.now_s()
        if not mate.is_parked:
            self._parked_since_s = None
            return False
        if self._parked_since_s is None:
            self._parked_since_s = now_s
        return now_s - self._parked_since_s > _PARKED_S * (1.0 if goes_before(self.robot, mate) else 0.5)

    def _has_come(self) -> bool:
        """There, or held on the way."""
        return self.robot.pilot.output.status in (ControlStatus.ARRIVED, ControlStatus.STUCK)

    def _is_free(self) -> bool:
        if self._mate is not None:
            return self._has_passed(self._mate)
        here = self.robot.estimate().T_map_base
        near = who_is_near(self.robot, here, self.robot.footprint_radius_m + self.clear)
        gap_m = float(gap_to_courses_m(np.array([here.xy]), near)[0])
        is_leaving = all(_goes_away(thing.xy, thing.velocity_mps, here) for thing in near)
        return is_leaving and gap_m > self.robot.footprint_radius_m + _APART_M


def _goes_away(xy: tuple[float, float], velocity: tuple[float, float], here: Pose2) -> bool:
    return (xy[0] - here.x) * velocity[0] + (xy[1] - here.y) * velocity[1] > 0.0
