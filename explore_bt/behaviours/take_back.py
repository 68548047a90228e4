"""Leaf: give what failed another chance."""

from __future__ import annotations

import math

from explore_bt.behaviours.give_up_goal import GivenUp
from explore_bt.tree import Input, Key, Leaf, Output, Status
from explore_bt.units import Area

__all__ = ["TakeBack"]

_SAME_M = 0.5


class TakeBack(Leaf):
    """Opens the places that proved too tight, and takes back goals that no way led to.

    What held the robot may have been noise, a person, or the spot it stood on; what holds it there again is
    the building. Places that were looked from in vain stay given up, and so do scraps.
    FAILURE if there is nothing to take back.
    """

    type_key = "take_back"
    values = (GivenUp,)

    chances: Input[int] = Input(int, default=1, ge=1, doc="how often the same place gets another chance")
    at_least: Input[float] = Input(
        Area,
        default=0.0,
        ge=0.0,
        doc="a goal that promised less, but something, is a scrap",
    )
    given_up: Output[tuple[GivenUp, ...]] = Output(
        tuple, default=Key("given_up"), doc="places not to try again"
    )

    _taken: tuple[tuple[float, float], ...] = ()

    def update(self) -> Status:
        """Take back, if there is anything that still has a chance."""
        tight = self.robot.reopen(self.chances)
        places: tuple[GivenUp, ...] = self.recall("given_up", ())
        again = [place for place in places if self._has_a_chance(place)]
        self.given_up = tuple(place for place in places if place not in again)
        self._taken += tuple(place.position for place in again)
        self.say(f"{tight} tight places opened, {len(again)} goals taken back")
        return Status.SUCCESS if tight or again else Status.FAILURE

    def _has_a_chance(self, place: GivenUp) -> bool:
        if place.was_seen or 0.0 < place.gain_m2 < self.at_least:
            return False
        before = sum(math.dist(place.position, other) <= _SAME_M for other in self._taken)
        return before < self.chances
