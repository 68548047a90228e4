"""How far the run goes before it pauses again."""

from __future__ import annotations

from collections.abc import Iterable
from fnmatch import fnmatchcase

from explore_bt.debug.commands import Step, StepKind
from explore_bt.debug.places import Place, Places
from explore_bt.errors import DebugError

__all__ = ["Stride"]

MOST = 1_000_000


class Stride:
    """Counts down what a ``Step`` asked for; without one it goes on for ever."""

    def __init__(self) -> None:
        self._kind: StepKind | None = None
        self._left = 0
        self._count = 0
        self._robot = "*"
        self._last: dict[int, str] = {}

    @classmethod
    def of(cls, step: Step, places: Places) -> Stride:
        """The stride that a step asks for; what counts as a change is counted from now on.

        Raises:
            DebugError: nothing to go by.
        """
        if not isinstance(step.kind, StepKind):
            raise DebugError(f'there is no step "{step.kind}"; known: tick, node, change')
        if not isinstance(step.count, int) or not 1 <= step.count <= MOST:
            raise DebugError(f"a step goes 1 to {MOST:,} times, not {step.count!r}")
        if not any(fnmatchcase(name, step.robot) for name in places.robots):
            places.robot(step.robot)
        stride = cls()
        stride._kind, stride._robot = step.kind, step.robot
        stride._left = stride._count = step.count
        if step.kind is StepKind.CHANGE:
            stride._last = {id(place.node): place.status for place in places}
        return stride

    def after(self, under_way: Stride) -> Stride:
        """This one; steps asked for before those of the same kind are done add up."""
        if under_way._kind is self._kind and under_way._robot == self._robot:
            self._left += under_way._left
            self._count += under_way._count
            self._last = under_way._last
        return self

    @property
    def watches_nodes(self) -> bool:
        """Whether ``next_node`` is to be asked."""
        return self._kind in (StepKind.NODE, StepKind.CHANGE)

    def who_stands(self, robots: Iterable[str]) -> list[str]:
        """In the coming tick: all but the one that a step of ticks is for."""
        if self._kind is not StepKind.TICK:
            return []
        return [name for name in robots if not fnmatchcase(name, self._robot)]

    @property
    def why(self) -> str:
        """What the run is doing, in words."""
        if self._kind is None:
            return "running"
        return f"stepping {_counted(self._count, str(self._kind))}"

    def next_tick(self) -> str:
        """A tick has passed: why to pause before the coming one; empty if there is no reason to."""
        stepped = f"stepped {_counted(self._count, 'tick')}"
        return self._passed(stepped) if self._kind is StepKind.TICK else ""

    def next_node(self, place: Place) -> str:
        """A node was ticked that is watched: why to pause after it; empty if there is no reason to."""
        if not fnmatchcase(place.robot.name, self._robot):
            return ""
        if self._kind is StepKind.NODE:
            return self._passed(f"stepped {_counted(self._count, 'node')} to after {place}")
        before, now = self._last.get(id(place.node)), place.status
        self._last[id(place.node)] = now
        return "" if before == now else self._passed(f"{place} changed from {before} to {now}")

    def end(self) -> None:
        """Go no further."""
        self._kind = None

    def _passed(self, what: str) -> str:
        self._left -= 1
        if self._left > 0:
            return ""
        self._kind = None
        return what


def _counted(number: int, noun: str) -> str:
    return f"1 {noun}" if number == 1 else f"{number} {noun}s"
