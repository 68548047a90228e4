"""Leaf: give what failed another chance."""

from __future__ import annotations

from explore_bt.behaviours.give_up_goal import GivenUp
from explore_bt.tree import Input, Key, Leaf, Output, Status

__all__ = ["TakeBack"]


class TakeBack(Leaf):
    """Opens the places that proved too tight, and takes back goals that no way led to.

    What held the robot may have been noise, a person, or the spot it stood on. Places that were looked
    from in vain stay given up. FAILURE if there is nothing to take back, or after ``times`` rounds.
    """

    type_key = "take_back"

    times: Input[int] = Input(int, default=3, ge=1, doc="how often in a mission")
    given_up: Output[tuple[GivenUp, ...]] = Output(
        tuple, default=Key("given_up"), doc="places not to try again"
    )

    _rounds = 0

    def update(self) -> Status:
        """Take back, if there is anything and patience is left."""
        if self._rounds >= self.times:
            self.say(f"{self._rounds} rounds were enough")
            return Status.FAILURE
        tight = self.robot.forget_avoided()
        places: tuple[GivenUp, ...] = self.recall("given_up", ())
        kept = tuple(place for place in places if place.was_seen)
        self.given_up = kept
        taken = len(places) - len(kept)
        self.say(f"{tight} tight places opened, {taken} goals taken back")
        if tight + taken == 0:
            return Status.FAILURE
        self._rounds += 1
        return Status.SUCCESS
