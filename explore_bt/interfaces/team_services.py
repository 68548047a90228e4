"""What a robot's leaves may ask about its team, and tell it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

from explore_bt.interfaces.allocator import Allocator
from explore_bt.types import Doing, Mate

__all__ = ["TeamServices"]


class TeamServices(Protocol):
    """The robot's place in its team; a robot alone has one without mates."""

    @property
    def name(self) -> str:
        """The robot's own name."""

    @property
    def mates(self) -> tuple[Mate, ...]:
        """The other robots that were heard of a moment ago."""

    @property
    def allocator(self) -> Allocator:
        """Who divides the work."""

    @property
    def yields(self) -> int:
        """See ``Mate.yields``: the robot's own number."""

    @property
    def right_of_way(self) -> tuple[int, str]:
        """See ``Mate.right_of_way``: the robot's own."""

    def claim(self, places: Sequence[tuple[float, float]]) -> None:
        """The robot goes to look from these, metres, ``map`` frame; what it claimed before is free."""

    def say_doing(self, doing: Doing) -> None:
        """What the robot is about."""

    def insist(self, until_s: float) -> None:
        """Until that mission time the robot goes first: it has nowhere to step aside to."""
