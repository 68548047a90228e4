"""Leaf: make a given place the goal."""

from __future__ import annotations

import math

from explore_bt.tree import Input, Key, Leaf, Output, Status
from explore_bt.types import Pose2, Waypoint
from explore_bt.units import Angle, Length

__all__ = ["ChoosePlace"]


class ChoosePlace(Leaf):
    """Sets the goal to a place of the ``map`` frame, for errands in a known map."""

    type_key = "choose_place"

    x: Input[float] = Input(Length, doc="metres along x of the map frame")
    y: Input[float] = Input(Length, doc="metres along y")
    yaw: Input[float] = Input(Angle, default=0.0, doc="heading to arrive with")
    goal: Output[Waypoint] = Output(Waypoint, default=Key("goal"), doc="the place")

    def update(self) -> Status:
        """Write the goal."""
        self.goal = Waypoint(Pose2(self.x, self.y, self.yaw), "place")
        away_m = math.dist(self.robot.estimate().T_map_base.xy, (self.x, self.y))
        self.say(f"({self.x:.1f}, {self.y:.1f}) is {away_m:.1f} m away as the crow flies")
        return Status.SUCCESS
