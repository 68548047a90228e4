"""One path being followed: leg after leg, with turns in place between them."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from explore_bt.interfaces import ControlStatus
from explore_bt.types import MotionLimits, MotionState, Path, Pose2
from explore_bt_controllers.feedback import turn_rate
from explore_bt_controllers.limiter import next_velocity
from explore_bt_controllers.look_ahead import fastest_velocity
from explore_bt_controllers.options import PursuitOptions
from explore_bt_controllers.progress import ProgressWatch
from explore_bt_controllers.track import Leg, legs_of, project
from explore_bt_controllers.turning import Turn

__all__ = ["Follower", "Wish", "at_rest"]

_AT_REST_MPS, _AT_REST_RPS = 0.02, 0.03
_LEG_END_M = 0.04  # at rest this near, a leg is done: an estimate that flickers moves its end by as much
_ALIGN_RAD = 0.2  # from a standstill, more than this is turned before driving: it costs less than the swerve
_TURNED_RAD = 0.05  # good enough to drive on; path feedback does the rest
_FACING_RAD = 0.02  # good enough to end with
_BEHIND_M, _AHEAD_M, _WIDE_M = 0.2, 0.4, 1.5  # where along the path the robot is looked for
_LOST_M = 0.15  # from this distance on it is looked for more widely
_HEADING_WEIGHT_M = 0.1
_APPROACHES = 3
_SLOWEST_SHARE = 0.2


@dataclass(frozen=True, slots=True)
class Wish:
    """What the path asks for at the end of the next period.

    Attributes:
        linear_mps: within the limits already.
        angular_rps: wanted turn rate, yet to be limited.
        angular_rps2: how fast that rate changes.
        status: ``running``, ``arrived`` or ``stuck``.
        reason: in words, why it is stuck.
    """

    linear_mps: float
    angular_rps: float
    angular_rps2: float = 0.0
    status: ControlStatus = ControlStatus.RUNNING
    reason: str = ""


class Follower:
    """Drives one path: turn towards a leg where it must, drive it, turn to the final heading."""

    def __init__(self, path: Path, options: PursuitOptions, footprint_radius_m: float) -> None:
        self._options = options
        self._path = path
        self._footprint_m = footprint_radius_m
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
        self._speeds: tuple[MotionLimits, int] | None = None

    def wish(self, pose: Pose2, motion: MotionState, limits: MotionLimits, dt_s: float) -> Wish:
        """What to command next; to be asked once per period."""
        if self._index < 0:
            self._enter(0, pose, abs(motion.twist.linear_mps) < _AT_REST_MPS)
        if self._turn is None and self._index < len(self._legs):
            wish = self._drive(self._legs[self._index], pose, motion, limits, dt_s)
        elif self._turn is not None:
            wish = self._rotate(self._turn, pose, motion, limits, dt_s)
        else:
            wish = self._arrive(pose, motion, limits, dt_s)
        if self._watch.waited_s > self._options.stuck_after:
            return _stuck(wish, f"no progress for {self._watch.waited_s:.1f} s")
        return wish

    def _enter(self, index: int, pose: Pose2, resting: bool) -> None:
        """Begin a leg where the robot is, turning first if it looks elsewhere; or come to the final turn."""
        self._index, self._speeds = index, None
        if index == len(self._legs):
            self._turn = Turn(self._goal.yaw_rad) if self._faces_away(pose) else None
            return
        leg = self._legs[index]
        self._along, _, error, _ = self._project(leg, pose, 0.0, _WIDE_M if index == 0 else _AHEAD_M)
        bearable = _ALIGN_RAD if resting else self._options.turn_from
        self._turn = Turn(pose.yaw_rad - error) if abs(error) > bearable else None

    def _faces_away(self, pose: Pose2) -> bool:
        error = abs(Turn(self._goal.yaw_rad).remaining(pose.yaw_rad))
        return error > (_FACING_RAD if self._turn_only else self._options.heading_tolerance)

    def _project(self, leg: Leg, pose: Pose2, low: float, high: float) -> tuple[float, float, float, float]:
        along, lateral, error, away = project(
            leg.points,
            leg.heading_rad,
            leg.spacing_m,
            pose.x,
            pose.y,
            pose.yaw_rad,
            low,
            high,
            _HEADING_WEIGHT_M,
        )
        return (along, lateral, error, away)

    def _locate(self, leg: Leg, pose: Pose2) -> tuple[float, float, float, float]:
        """Near where the robot was; more widely if it is not there, for SLAM may have moved it."""
        found = self._project(leg, pose, self._along - _BEHIND_M, self._along + _AHEAD_M)
        if found[3] > _LOST_M:
            wide = self._project(leg, pose, self._along - _WIDE_M, self._along + _WIDE_M)
            return wide if wide[3] < 0.5 * found[3] else found
        return found

    def _drive(self, leg: Leg, pose: Pose2, motion: MotionState, limits: MotionLimits, dt_s: float) -> Wish:
        self._along, lateral, error, away = self._locate(leg, pose)
        left = leg.length_m - self._along
        speed = motion.twist.linear_mps
        if left < _LEG_END_M and abs(speed) < _AT_REST_MPS:
            self._enter(self._index + 1, pose, True)
            return at_rest(motion, limits, dt_s)
        self._watch.see(("drive", self._index, self._approaches), left, dt_s)
        if away > self._options.off_path:
            reason = f"{away:.2f} m off the path, {self._options.off_path:.2f} m is allowed"
            return _stuck(at_rest(motion, limits, dt_s), reason)
        if abs(error) > self._options.turn_from + 0.3:  # more than would have begun a turn: no to and fro
            self._turn = Turn(pose.yaw_rad - error)
            return at_rest(motion, limits, dt_s)
        linear = self._next_speed(leg, lateral, error, motion, limits, dt_s)
        return self._steer(leg, pose, linear, motion, dt_s)

    def _next_speed(
        self, leg: Leg, lateral: float, error: float, motion: MotionState, limits: MotionLimits, dt_s: float
    ) -> float:
        if self._speeds is None or self._speeds[0] is not limits or self._speeds[1] != self._index:
            self._speeds = (limits, self._index)
            self._limits_ahead = np.minimum(
                leg.speed_limits(limits, self._options.lateral_acceleration),
                limits.speed_mps * self._ease(leg),
            )
        k = min(int(self._along / leg.spacing_m), len(leg.points) - 1)
        one_metre_turn = turn_rate(
            1.0, lateral, error, leg.curvature[k], leg.curvature_rate[k], self._options.convergence
        )
        cap = min(
            limits.speed_mps * max(0.3, math.cos(error)),
            limits.turn_rate_rps / max(abs(one_metre_turn), 1e-6),
        )
        return float(
            fastest_velocity(
                motion.twist.linear_mps,
                motion.linear_acceleration_mps2,
                cap,
                self._along,
                self._limits_ahead,
                leg.spacing_m,
                leg.length_m,
                dt_s,
                limits.speed_mps,
                limits.acceleration_mps2,
                limits.jerk_mps3,
            )
        )

    def _ease(self, leg: Leg) -> NDArray[np.float64]:
        """(N,) share of full speed along a leg: less where little room is left beside the footprint."""
        offsets = leg.points[:, None, :] - self._path.poses[None, :, :2]
        nearest = np.argmin(np.einsum("ijk,ijk->ij", offsets, offsets), axis=1)
        room_m = self._path.clearance_m[nearest] - self._footprint_m
        return np.clip(room_m / max(self._options.slow_below, 1e-6), _SLOWEST_SHARE, 1.0)

    def _steer(self, leg: Leg, pose: Pose2, linear: float, motion: MotionState, dt_s: float) -> Wish:
        """Turn rate for where the robot will be when it is reached."""
        twist = motion.twist
        mean = 0.5 * (twist.linear_mps + linear)
        yaw = pose.yaw_rad + 0.5 * twist.angular_rps * dt_s
        then = Pose2(
            pose.x + mean * dt_s * math.cos(yaw),
            pose.y + mean * dt_s * math.sin(yaw),
            pose.yaw_rad + twist.angular_rps * dt_s,
        )
        along, lateral, error, _ = self._project(leg, then, self._along - _BEHIND_M, self._along + _AHEAD_M)
        k = min(int(along / leg.spacing_m), len(leg.points) - 1)
        bend, change = float(leg.curvature[k]), float(leg.curvature_rate[k])
        rate = turn_rate(linear, lateral, error, bend, change, self._options.convergence)
        gain = (linear - twist.linear_mps) / dt_s
        return Wish(linear, rate, change * linear * linear + bend * gain)

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
            return _stuck(still, f"still {away:.2f} m from the goal after {_APPROACHES} more approaches")
        self._approaches += 1
        yaw = math.atan2(self._goal.y - pose.y, self._goal.x - pose.x)
        rest = Pose2(self._goal.x, self._goal.y, yaw)
        self._legs = legs_of(np.array([pose.as_array(), rest.as_array()]), self._options.turn_from)
        self._enter(0, pose, True)
        return still


def at_rest(motion: MotionState, limits: MotionLimits, dt_s: float) -> Wish:
    """The way to a standstill, and staying there."""
    linear = next_velocity(
        motion.twist.linear_mps,
        motion.linear_acceleration_mps2,
        0.0,
        0.0,
        dt_s,
        -limits.speed_mps,
        limits.speed_mps,
        limits.acceleration_mps2,
        limits.jerk_mps3,
    )
    return Wish(float(linear), 0.0)


def _stuck(wish: Wish, reason: str) -> Wish:
    return Wish(wish.linear_mps, wish.angular_rps, wish.angular_rps2, ControlStatus.STUCK, reason)
