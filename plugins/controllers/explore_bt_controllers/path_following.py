"""What controllers that follow a path have in common: all but the driving law."""

from __future__ import annotations

import math
from abc import abstractmethod

import numpy as np

from explore_bt.interfaces import Controller, ControlOutput, ControlStatus, RobotContext
from explore_bt.types import Estimate, MotionLimits, MotionState, Path, Pose2, Scan2D, Twist2
from explore_bt_controllers.driving_law import DrivingLaw
from explore_bt_controllers.follower import Follower
from explore_bt_controllers.options import FollowerOptions
from explore_bt_controllers.wish import Wish, at_rest, next_turn_rate

__all__ = ["PathFollowing"]


class PathFollowing(Controller):
    """Follows paths leg by leg, by the driving law of the class derived from it."""

    def __init__(self, options: FollowerOptions) -> None:
        super().__init__(options)
        self._following = options
        self._limits = MotionLimits()
        self._footprint_m = 0.0
        self._follower: Follower | None = None
        self._given_up = ""

    @abstractmethod
    def _law_for(self, path: Path) -> DrivingLaw:
        """The law to drive this path by."""

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
        self._follower, self._given_up = Follower(path, self._following, self._law_for(path)), ""

    def hold(self) -> None:
        """See ``Controller.hold``."""
        self._follower, self._given_up = None, ""

    def step(
        self,
        estimate: Estimate,
        scan: Scan2D | None,  # noqa: ARG002  # offered by the contract; obstacles come by ``see``
        motion: MotionState,
        dt_s: float,
    ) -> ControlOutput:
        """See ``Controller.step``."""
        wish = at_rest(motion, self._limits, dt_s)
        if self._follower is not None and not self._given_up:
            wish = self._follower.wish(estimate, motion, self._limits, dt_s)
            if wish.status is ControlStatus.STUCK:
                self._given_up = wish.reason
        twist = Twist2(wish.linear_mps, next_turn_rate(wish, motion, self._limits, dt_s))
        return ControlOutput(twist, self._status(wish, twist), self._given_up)

    def _status(self, wish: Wish, twist: Twist2) -> ControlStatus:
        if self._given_up:
            return ControlStatus.STUCK
        if self._follower is not None:
            return wish.status
        resting = math.hypot(twist.linear_mps, twist.angular_rps) < 1e-6
        return ControlStatus.IDLE if resting else ControlStatus.RUNNING
