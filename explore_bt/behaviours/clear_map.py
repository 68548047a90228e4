"""Leaf: forget the obstacles nearby, for some may have gone."""

from __future__ import annotations

from explore_bt.tree import Input, Leaf, Status
from explore_bt.units import Length

__all__ = ["ClearMap"]


class ClearMap(Leaf):
    """Has the map call everything within a circle free until it is seen again.

    What the lidar sees is back at once; what has gone, or was noise, no longer closes a way. Things that the
    lidar does not see now, and that stand there all the same, are forgotten too: the safety gate has the
    newest scans, but no other knowledge of them.
    FAILURE where the SLAM plugin cannot forget.
    """

    type_key = "clear_map"

    radius: Input[float] = Input(Length, default=2.0, ge=0.1, doc="how far around the robot")

    def update(self) -> Status:
        """Forget, once."""
        if not self.robot.clear_map(self.radius):
            self.say("this SLAM cannot forget")
            return Status.FAILURE
        self.say(f"obstacles within {self.radius:.1f} m are forgotten until they are seen again")
        return Status.SUCCESS
