"""Leaf: turn on the spot."""

from __future__ import annotations

import math

import numpy as np

from explore_bt.interfaces import ControlStatus
from explore_bt.tree import Input, Leaf, Status
from explore_bt.types import Path, Pose2
from explore_bt.units import Angle

__all__ = ["Turn"]


class Turn(Leaf):
    """Turns by an angle, counter-clockwise positive; the paper's reversal is a turn by 180°."""

    type_key = "turn"

    by: Input[float] = Input(Angle, default=math.pi, ge=-math.pi, le=math.pi, doc="how far")

    def initialise(self) -> None:
        """Hand the controller a path of one pose."""
        here = self.robot.estimate().T_map_base
        target = here.compose(Pose2(0.0, 0.0, self.by))
        self.robot.pilot.follow(Path(target.as_array()[None, :], np.array([np.inf])))
        self.say(f"turning by {math.degrees(self.by):.0f}°")

    def update(self) -> Status:
        """Until the controller says it has arrived."""
        output = self.robot.pilot.output
        if output.status is ControlStatus.ARRIVED:
            self.say(f"turned by {math.degrees(self.by):.0f}°")
            return Status.SUCCESS
        if output.status is ControlStatus.STUCK:
            self.say(f"the turn does not get on: {output.reason}")
            return Status.FAILURE
        return Status.RUNNING

    def terminate(self, new_status: Status) -> None:
        """A turn that is cut off comes to rest."""
        if new_status is not Status.SUCCESS:
            self.robot.pilot.hold()
