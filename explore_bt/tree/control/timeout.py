"""A limit on how long a child may run."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import cast

from py_trees.behaviour import Behaviour
from py_trees.common import Status

from explore_bt.tree.control.base import Decorator, Work

__all__ = ["Timeout"]


class Timeout(Decorator):
    """Halts its child and fails once ``duration_s`` of mission time have passed since the round began.

    A child whose time is up is not ticked again, as in BehaviorTree.CPP.

    Args:
        name: shown to people.
        child: what may take so long.
        duration_s: seconds of mission time; may be changed between ticks, also while the child runs.
        now_s: the mission's clock; never the wall's, which goes on while a debugger holds the run.
    """

    def __init__(self, name: str, child: Behaviour, duration_s: float, now_s: Callable[[], float]) -> None:
        super().__init__(name, child)
        self.duration_s = duration_s
        self._now_s = now_s

    def initialise(self) -> None:
        """The time begins."""
        self._begun_s = self._now_s()

    def memory(self) -> Mapping[str, object]:
        """When the time began: mission time goes on where it stood."""
        return {"begun_s": self._begun_s}

    def restore(self, memory: Mapping[str, object]) -> None:
        """Let no more time be left than there was."""
        super().restore(memory)
        self._begun_s = cast(float, memory["begun_s"])

    def work(self) -> Work:
        """Tick the child while there is time."""
        if self._now_s() >= self._begun_s + self.duration_s:
            self.feedback_message = f"gave up after {self.duration_s:g} s"
            return Status.FAILURE
        return (yield from self.ticked(self.child))
