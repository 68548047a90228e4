"""Leaves that play a script in another's place: the same name and ports, no robot needed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, ClassVar

from explore_bt.tree.leaf import Leaf, Status
from explore_bt.tree.ports import Key, PortUnsetError

__all__ = ["MockedLeaf", "Round", "Script", "mocked"]


@dataclass(frozen=True, slots=True)
class Round:
    """One round of a leaf, from its first tick to its end.

    Attributes:
        running: so many ticks it answers ``RUNNING``.
        after_s: and for at least so much mission time.
        answer: ``SUCCESS`` or ``FAILURE``; None goes on running for ever.
    """

    running: int
    after_s: float
    answer: Status | None


@dataclass(frozen=True, slots=True)
class Script:
    """What a mocked leaf does.

    Attributes:
        rounds: one after the other; one that is cut off is over.
        cycles: whether the first comes after the last again; else the last is repeated.
        say: its words, in every tick.
        outputs: port -> value, or ``Key`` of an entry to copy; written when a round ends.
    """

    rounds: tuple[Round, ...]
    cycles: bool = True
    say: str = ""
    outputs: Mapping[str, object] = field(default_factory=dict)

    def round(self, number: int) -> Round:
        """The round of that number, counted from 0."""
        last = len(self.rounds) - 1
        return self.rounds[number % (last + 1)] if self.cycles else self.rounds[min(number, last)]


class MockedLeaf(Leaf):
    """Base of the leaves that ``mocked`` makes."""

    script: ClassVar[Script]

    _rounds_begun = 0

    def initialise(self) -> None:
        """The next round of the script."""
        self._round = self.script.round(self._rounds_begun)
        self._rounds_begun += 1
        self._ticks = 0
        self._begun_s = self.robot.now_s()

    def update(self) -> Status:
        """What the script says for this tick."""
        self.say(self.script.say or f"mocked, round {self._rounds_begun}")
        self._ticks += 1
        is_over = self._ticks > self._round.running and self._lasted_s >= self._round.after_s
        if not is_over or self._round.answer is None:
            return Status.RUNNING
        for port, value in self.script.outputs.items():
            setattr(self, port, self._copied(port, value.name) if isinstance(value, Key) else value)
        return self._round.answer

    @property
    def _lasted_s(self) -> float:
        return self.robot.now_s() - self._begun_s + 1e-9  # ticks come at sums of a period

    def _copied(self, port: str, entry: str) -> object:
        if entry not in self.blackboard:
            raise PortUnsetError(f"{self.name}: mocked {port} copies ${entry}, which nothing has written yet")
        return self.blackboard[entry]


def mocked(leaf: type[Leaf], script: Script) -> type[MockedLeaf]:
    """A leaf with the key and the ports of ``leaf`` that plays ``script``."""
    members: dict[str, Any] = {"type_key": leaf.type_key, "script": script, "__doc__": leaf.__doc__}
    return type(f"Mocked{leaf.__name__}", (MockedLeaf,), {**leaf.inputs, **leaf.outputs, **members})
