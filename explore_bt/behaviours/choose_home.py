"""Leaf: make home the goal."""

from __future__ import annotations

from explore_bt.tree import Key, Leaf, Output, Status
from explore_bt.types import Waypoint

__all__ = ["ChooseHome"]


class ChooseHome(Leaf):
    """Sets the goal to the pose at which the mission began."""

    type_key = "choose_home"

    goal: Output[Waypoint] = Output(Waypoint, default=Key("goal"), doc="home")

    def update(self) -> Status:
        """Write the goal."""
        home = self.robot.home
        self.goal = Waypoint(home, "home")
        away_m = self.robot.estimate().T_map_base.distance_to(home)
        self.say(f"home is {away_m:.1f} m away as the crow flies")
        return Status.SUCCESS
