"""Robots that a debugger holds while the others go on."""

from __future__ import annotations

from collections.abc import Iterable

__all__ = ["HeldRobots"]

_WHY = "held by the debugger: the others go on"


class HeldRobots:
    """Counts down the ticks that each of them is let go for."""

    def __init__(self) -> None:
        self._left: dict[str, int] = {}

    def __contains__(self, name: str) -> bool:
        """Whether it is held, or would be again after a step."""
        return name in self._left

    @property
    def names(self) -> tuple[str, ...]:
        """Of all of them."""
        return tuple(sorted(self._left))

    def hold(self, name: str) -> None:
        """From the next tick on."""
        self._left[name] = 0

    def let_go(self, name: str) -> None:
        """For good."""
        self._left.pop(name, None)

    def step(self, name: str, ticks: int) -> None:
        """Let it go for so many ticks more."""
        self._left[name] += ticks

    def before_tick(self, paused: dict[str, str], others: Iterable[str] = ()) -> None:
        """A tick comes: ``paused`` is to say who stands in it, and why.

        Args:
            paused: as in ``Runner.paused``; what others have written there stays.
            others: they stand in this tick too.
        """
        for name in [name for name, why in paused.items() if why == _WHY]:
            del paused[name]
        standing = {name for name, left in self._left.items() if not left} | set(others)
        for name in self._left:
            self._left[name] = max(self._left[name] - 1, 0)
        for name in standing:
            paused.setdefault(name, _WHY)
