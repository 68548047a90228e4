"""Leaf: strike a goal that could not be reached off the list."""

from __future__ import annotations

from dataclasses import dataclass

from explore_bt.tree import Input, Key, Leaf, Output, Status
from explore_bt.types import Waypoint

__all__ = ["GiveUpGoal", "GivenUp"]


@dataclass(frozen=True, slots=True)
class GivenUp:
    """A place that is not tried again, why, and the frontier it was to show; metres, ``map`` frame.

    Attributes:
        was_seen: whether the robot looked from there, in vain; else it never got there.
        gain_m2: new floor that was expected there; 0 where nobody asked.
    """

    position: tuple[float, float]
    reason: str
    looks_at: tuple[float, float] | None = None
    was_seen: bool = False
    gain_m2: float = 0.0


class GiveUpGoal(Leaf):
    """Remembers the present goal as one that is not worth another try."""

    type_key = "give_up_goal"
    values = (GivenUp,)

    goal: Input[Waypoint] = Input(Waypoint, default=Key("goal"), doc="the goal that failed")
    failure: Input[str] = Input(str, default=Key("failure"), doc="code of the reason")
    given_up: Output[tuple[GivenUp, ...]] = Output(tuple, default=Key("given_up"), doc="all such places")

    def update(self) -> Status:
        """Append to the memory."""
        x, y = self.goal.position
        place = GivenUp((x, y), self.failure, self.goal.looks_at, gain_m2=self.goal.expected_gain_m2)
        self.given_up = (*self.recall("given_up", ()), place)
        self.say(f"({x:.1f}, {y:.1f}) is given up: {self.failure}")
        return Status.SUCCESS
