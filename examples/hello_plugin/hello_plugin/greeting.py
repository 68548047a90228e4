"""A leaf that says hello."""

from __future__ import annotations

from explore_bt.tree import Input, Key, Leaf, Output, Status

__all__ = ["Hello"]


class Hello(Leaf):
    """Greets somebody, once a tick, as often as it is asked to."""

    type_key = "hello"

    to: Input[str] = Input(str, default="world", doc="whom to greet")
    times: Input[int] = Input(int, default=1, ge=1, doc="how many ticks it takes")
    greeting: Output[str] = Output(str, default=Key("greeting"), doc="what was said")

    def initialise(self) -> None:
        """Nobody has been greeted yet."""
        self._said = 0

    def update(self) -> Status:
        """Greet once more."""
        self._said += 1
        self.greeting = f"hello {self.to}"
        self.say(f"{self.greeting} ({self._said} of {self.times})")
        return Status.SUCCESS if self._said >= self.times else Status.RUNNING
