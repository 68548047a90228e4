"""Controller ``pursuit``: curvature ahead, Samson's feedback, limits kept period by period."""

from __future__ import annotations

import math
from typing import ClassVar

import numpy as np

from explore_bt.interfaces import (
    API_VERSION,
    Controller,
    ControlOutput,
    ControlStatus,
    PluginOptions,
    RobotContext,
)
from explore_bt.types import Estimate, MotionLimits, MotionState, Path, Pose2, Scan2D, Twist2
from explore_bt_controllers.follower import Follower, Wish, at_rest
from explore_bt_controllers.limiter import next_velocity
from explore_bt_controllers.options import PursuitOptions

__all__ = ["Pursuit"]


class Pursuit(Controller):
    """Follows a path by its curvature and by feedback on the offset from it.

    Speed is the greatest from which a jerk-limited brake keeps every limit that the path's curvature sets
    ahead, its end included. Bends too sharp to drive are turned in place.
    """

    name: ClassVar[str] = "pursuit"
    api_version: ClassVar[int] = API_VERSION
    Options: ClassVar[type[PluginOptions]] = PursuitOptions

    def __init__(self, options: PursuitOptions) -> None:
        super().__init__(options)
        self._options = options
        self._limits = MotionLimits()
        self._footprint_m = 0.0
        self._follower: Follower | None = None
        self._given_up = ""

    def setup(self, context: RobotContext) -> None:
        """Learn the limits and compile the kernels."""
        bend = np.linspace(0.0, 1.0, 20)
        poses = np.column_stack((bend, bend * bend, np.arctan(2.0 * bend)))
        self.follow(Path(poses, np.ones(len(poses))))
        for yaw in (0.0, 2.0):
            self.step(Estimate(0.0, Pose2(0.0, 0.0, yaw)), None, MotionState(), 0.05)
        self.hold()
        self._footprint_m = context.footprint_radius_m
        self.limit(context.limits)

    def limit(self, limits: MotionLimits) -> None:
        """Keep these limits from the next step on; a motion beyond them is brought under them."""
        self._limits = limits

    def follow(self, path: Path) -> None:
        """See ``Controller.follow``."""
        self._follower, self._given_up = Follower(path, self._options, self._footprint_m), ""

    def hold(self) -> None:
        """See ``Controller.hold``."""
        self._follower, self._given_up = None, ""

    def step(
        self,
        estimate: Estimate,
        scan: Scan2D | None,  # noqa: ARG002  # offered by the contract; obstacles are the safety gate's
        motion: MotionState,
        dt_s: float,
    ) -> ControlOutput:
        """See ``Controller.step``."""
        wish = at_rest(motion, self._limits, dt_s)
        if self._follower is not None and not self._given_up:
            wish = self._follower.wish(estimate.T_map_base, motion, self._limits, dt_s)
            if wish.status is ControlStatus.STUCK:
                self._given_up = wish.reason
        twist = Twist2(wish.linear_mps, self._turn_rate(wish, motion, dt_s))
        return ControlOutput(twist, self._status(wish, twist), self._given_up)

    def _turn_rate(self, wish: Wish, motion: MotionState, dt_s: float) -> float:
        limits = self._limits
        return float(
            next_velocity(
                motion.twist.angular_rps,
                motion.angular_acceleration_rps2,
                wish.angular_rps,
                wish.angular_rps2,
                dt_s,
                -limits.turn_rate_rps,
                limits.turn_rate_rps,
                limits.turn_acceleration_rps2,
                limits.turn_jerk_rps3,
            )
        )

    def _status(self, wish: Wish, twist: Twist2) -> ControlStatus:
        if self._given_up:
            return ControlStatus.STUCK
        if self._follower is not None:
            return wish.status
        resting = math.hypot(twist.linear_mps, twist.angular_rps) < 1e-6
        return ControlStatus.IDLE if resting else ControlStatus.RUNNING
