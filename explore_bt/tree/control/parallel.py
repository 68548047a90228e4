"""Several children in one tick."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import cast

from py_trees.behaviour import Behaviour
from py_trees.common import Status

from explore_bt.tree.control.base import ControlNode, Work

__all__ = ["Parallel"]


class Parallel(ControlNode):
    """Ticks all children that have not ended, until enough have succeeded or failed.

    Stops right at its threshold, as BehaviorTree.CPP's ``Parallel``: later children are not ticked any
    more in that tick, running ones are halted. It also fails as soon as too few children are left to
    succeed.

    Args:
        name: shown to people.
        children: ticked in this order, in one thread.
        success: how many children have to succeed; None for all.
        failure: how many failures make it fail.
    """

    def __init__(
        self, name: str, children: Sequence[Behaviour], success: int | None = None, failure: int = 1
    ) -> None:
        super().__init__(name, children)
        self._needed = len(children) if success is None else success
        self._failure = failure

    def initialise(self) -> None:
        """No child has ended."""
        self._ended: dict[int, Status] = {}

    def memory(self) -> Mapping[str, object]:
        """Which children have ended, and how."""
        return {"ended": {index: status.value for index, status in self._ended.items()}}

    def restore(self, memory: Mapping[str, object]) -> None:
        """Do not tick those again."""
        super().restore(memory)
        ended = cast(Mapping[int, str], memory["ended"])
        self._ended = {index: Status(status) for index, status in ended.items()}

    def work(self) -> Work:
        """Tick those that have not ended."""
        for index, child in enumerate(self.children):
            if index not in self._ended:
                status = yield from self.ticked(child)
                if status is not Status.RUNNING:
                    self._ended[index] = status
            verdict = self._verdict()
            if verdict is not Status.RUNNING:
                return verdict
        return Status.RUNNING

    def _verdict(self) -> Status:
        ended = list(self._ended.values())
        successes, failures = ended.count(Status.SUCCESS), ended.count(Status.FAILURE)
        self.feedback_message = f"{successes} of {self._needed} succeeded, {failures} failed"
        if successes >= self._needed:
            return Status.SUCCESS
        if failures >= self._failure or len(self.children) - failures < self._needed:
            return Status.FAILURE
        return Status.RUNNING
