"""Leaf: wait."""

from __future__ import annotations

from explore_bt.tree import Input, Leaf, Status
from explore_bt.units import Duration

__all__ = ["Wait"]


class Wait(Leaf):
    """Succeeds after a while of mission time; the robot does what it was doing."""

    type_key = "wait"

    duration: Input[float] = Input(Duration, default=1.0, ge=0.0, doc="how long")

    def initialise(self) -> None:
        """Start the clock."""
        self._until_s = self.robot.now_s() + self.duration

    def update(self) -> Status:
        """RUNNING until the time is over."""
        remaining_s = self._until_s - self.robot.now_s()
        self.say(f"{max(remaining_s, 0.0):.1f} s to go")
        return Status.SUCCESS if remaining_s <= 0.0 else Status.RUNNING
