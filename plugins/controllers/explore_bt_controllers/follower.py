"""One path being followed: leg after leg, with turns in place between them."""

from __future__ import annotations

import math

import numpy as np

from explore_bt.interfaces import ControlStatus
from explore_bt.types import Estimate, MotionLimits, MotionState, Path, Pose2
from explore_bt_controllers.driving_law import DrivingLaw, Place
from explore_bt_controllers.options import FollowerOptions
from explore_bt_controllers.progress import ProgressWatch
from explore_bt_controllers.track import Leg, legs_of
from explore_bt_controllers.turning import Turn
from explore_bt_controllers.wish import Wish, at_rest, stuck

__all__ = ["Follower"]

_AT_REST_MPS, _AT_REST_RPS = 0.02, 0.03
_LEG_END_M = 0.04  # at rest this near, a leg is done: an estimate that flickers moves its end by as much
_ALIGN_RAD = 0.2  # from a standstill, more than this is turned before driving: it costs less than the swerve
_TURNED_RAD = 0.05  # good enough to drive on; path feedback does the rest
_FACING_RAD = 0.02  # good enough to end with
_JOIN_M, _WIDE_M = 0.4, 1.5  # how far along the path the robot is looked for, at a bend and else
_LOST_M = 0.15  # from this distance on it is looked for more widely
_APPROACHES = 3


class Follower:
    """Drives one path: turn towards a leg where it must, drive it, turn to the final heading."""

    def __init__(self, path: Path, options: FollowerOptions, law: DrivingLaw) -> None:
        self._options = options
        self._law = law
        self._goal = path.goal
        self._legs = legs_of(path.poses, options.turn_from)
        if sum(leg.length_m for leg in self._legs) < options.position_tolerance / 2.0:
            self._legs = []
        self._turn_only = not self._legs
        self._index = -1  # no leg entered yet
        self._along = 0.0
        self._turn: Turn | None = None
        self._watch = ProgressWatch()
        self._approaches = 0

    def wish(self, estimate: Estimate, motion: MotionState, limits: MotionLimits, dt_s: float) -> Wish:
        """What to command next; to be asked once per period."""
        pose = estimate.T_map_base
        if self._index < 0:
            self._enter(0, pose, abs(motion.twist.linear_mps) < _AT_REST_MPS)
        if self._turn is None and self._index < len(self._legs):
            wish = self._drive(self._legs[self._index], estimate, motion, limits, dt_s)
        elif self._turn is not None:
            wish = self._rotate(self._turn, pose, motion, limits, dt_s)
        else:
            wish = self._arrive(pose, motion, limits, dt_s)
        if self._watch.waited_s > self._options.stuck_after:
            hindrance = self._law.hindrance() if self._turn is None else ""
            reason = f"no progress for {self._watch.waited_s:.1f} s"
            return stuck(wish, f"{reason}: {hindrance}" if hindrance else reason)
        return wish

    def _enter(self, index: int, pose: Pose2, resting: bool) -> None:
        """Begin a leg where the robot is, turning first if it looks elsewhere; or come to the final turn."""
        self._index = index
        if index == len(self._legs):
            self._turn = Turn(self._goal.yaw_rad) if self._faces_away(pose) else None
            return
        leg = self._legs[index]
        self._along, _, error, _ = leg.project_between(pose, 0.0, _WIDE_M if index == 0 else _JOIN_M)
        bearable = _ALIGN_RAD if resting else self._options.turn_from
        self._turn = Turn(pose.yaw_rad - error) if abs(error) > bearable else None

    def _faces_away(self, pose: Pose2) -> bool:
        error = abs(Turn(self._goal.yaw_rad).remaining(pose.yaw_rad))
        return error > (_FACING_RAD if self._turn_only else self._options.heading_tolerance)

    def _locate(self, leg: Leg, pose: Pose2) -> tuple[float, float, float, float]:
        """Near where the robot was; more widely if it is not there, for SLAM may have moved it."""
        found = leg.project_near(pose, self._along)
        if found[3] > _LOST_M:
            wide = leg.project_between(pose, self._along - _WIDE_M, self._along + _WIDE_M)
            return wide if wide[3] < 0.5 * found[3] else found
        return found

    def _drive(
        self, leg: Leg, estimate: Estimate, motion: MotionState, limits: MotionLimits, dt_s: float
    ) -> Wish:
        pose = estimate.T_map_base
        self._along, lateral, error, away = self._locate(leg, pose)
        left = leg.length_m - self._along
        speed = motion.twist.linear_mps
        if left < _LEG_END_M and abs(speed) < _AT_REST_MPS:
            self._enter(self._index + 1, pose, True)
            return at_rest(motion, limits, dt_s)
        self._watch.see(("drive", self._index, self._approaches), left, dt_s)
        if away > self._options.off_path:
            reason = f"{away:.2f} m off the path, {self._options.off_path:.2f} m is allowed"
            return stuck(at_rest(motion, limits, dt_s), reason)
        if abs(error) > self._options.turn_from + 0.3:  # more than would have begun a turn: no to and fro
            self._turn = Turn(pose.yaw_rad - error)
            return at_rest(motion, limits, dt_s)
        place = Place(leg, pose, estimate.stamp_s, self._along, lateral, error)
        return self._law.drive(place, motion, limits, dt_s)

    def _rotate(
        self, turn: Turn, pose: Pose2, motion: MotionState, limits: MotionLimits, dt_s: float
    ) -> Wish:
        remaining = turn.remaining(pose.yaw_rad)
        rate = motion.twist.angular_rps
        still = at_rest(motion, limits, dt_s)
        self._watch.see(("turn", self._index, self._approaches), abs(remaining) + abs(still.linear_mps), dt_s)
        if abs(motion.twist.linear_mps) > _AT_REST_MPS:
            return still
        if self._has_turned(turn, remaining, rate):
            self._turn = None
        rate, gain = turn.wanted_rate(pose.yaw_rad, rate, motion.angular_acceleration_rps2, limits, dt_s)
        return Wish(still.linear_mps, rate, gain)

    def _has_turned(self, turn: Turn, remaining: float, rate: float) -> bool:
        """Before a leg, when it can be driven; at the end, at rest and exactly, or as exactly as planned."""
        if self._index < len(self._legs):
            return abs(remaining) < _TURNED_RAD
        if turn.is_over:  # what is left is noise, or within the tolerance all the same
            return abs(remaining) < self._options.heading_tolerance
        return abs(remaining) < _FACING_RAD and abs(rate) < _AT_REST_RPS

    def _arrive(self, pose: Pose2, motion: MotionState, limits: MotionLimits, dt_s: float) -> Wish:
        """At the end of the last leg, at rest: there, or a little more to drive."""
        still = at_rest(motion, limits, dt_s)
        away = pose.distance_to(self._goal)
        if self._turn_only or away <= self._options.position_tolerance:
            return Wish(still.linear_mps, 0.0, 0.0, ControlStatus.ARRIVED)
        if self._approaches == _APPROACHES:
            return stuck(still, f"still {away:.2f} m from the goal after {_APPROACHES} more approaches")
        self._approaches += 1
        yaw = math.atan2(self._goal.y - pose.y, self._goal.x - pose.x)
        rest = Pose2(self._goal.x, self._goal.y, yaw)
        self._legs = legs_of(np.array([pose.as_array(), rest.as_array()]), self._options.turn_from)
        self._enter(0, pose, True)
        return still
