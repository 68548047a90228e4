"""Driving by the path's curvature and by feedback on the offset from it."""

from __future__ import annotations

import math

from explore_bt.types import MotionLimits, MotionState, Path, Pose2
from explore_bt_controllers.driving_law import Place
from explore_bt_controllers.feedback import turn_rate
from explore_bt_controllers.options import PursuitOptions
from explore_bt_controllers.speed_ahead import SpeedAhead
from explore_bt_controllers.wish import Wish

__all__ = ["CurvatureLaw"]


class CurvatureLaw:
    """The driving law of ``pursuit``; sees the path alone."""

    def __init__(self, path: Path, options: PursuitOptions, footprint_radius_m: float) -> None:
        self._convergence_m = options.convergence
        self._speeds = SpeedAhead(path, options, footprint_radius_m)

    def drive(self, place: Place, motion: MotionState, limits: MotionLimits, dt_s: float) -> Wish:
        """See ``DrivingLaw.drive``."""
        leg, error = place.leg, place.heading_error_rad
        k = leg.index_at(place.along_m)
        one_metre_turn = turn_rate(
            1.0, place.lateral_m, error, leg.curvature[k], leg.curvature_rate[k], self._convergence_m
        )
        cap = min(
            limits.speed_mps * max(0.3, math.cos(error)),
            limits.turn_rate_rps / max(abs(one_metre_turn), 1e-6),
        )
        linear = self._speeds.fastest(leg, place.along_m, cap, motion, limits, dt_s)
        return self._steer(place, linear, motion, dt_s)

    def hindrance(self) -> str:
        """See ``DrivingLaw.hindrance``."""
        return ""

    def _steer(self, place: Place, linear: float, motion: MotionState, dt_s: float) -> Wish:
        """Turn rate for where the robot will be when it is reached."""
        twist, pose, leg = motion.twist, place.pose, place.leg
        mean = 0.5 * (twist.linear_mps + linear)
        yaw = pose.yaw_rad + 0.5 * twist.angular_rps * dt_s
        then = Pose2(
            pose.x + mean * dt_s * math.cos(yaw),
            pose.y + mean * dt_s * math.sin(yaw),
            pose.yaw_rad + twist.angular_rps * dt_s,
        )
        along, lateral, error, _ = leg.project_near(then, place.along_m)
        k = leg.index_at(along)
        bend, change = float(leg.curvature[k]), float(leg.curvature_rate[k])
        rate = turn_rate(linear, lateral, error, bend, change, self._convergence_m)
        gain = (linear - twist.linear_mps) / dt_s
        return Wish(linear, rate, change * linear * linear + bend * gain)
