"""Sequences: all children, one after the other."""

from __future__ import annotations

from collections.abc import Mapping
from typing import cast

from py_trees.common import Status

from explore_bt.tree.control.base import ControlNode, Work, halt

__all__ = ["ReactiveSequence", "Sequence"]


class Sequence(ControlNode):
    """Succeeds when every child has; fails with the first that fails.

    Has memory, as BehaviorTree.CPP's ``Sequence``: a child that has succeeded is not ticked again before
    the round is over.
    """

    def initialise(self) -> None:
        """Start at the first child."""
        self._index = 0

    def memory(self) -> Mapping[str, object]:
        """The child it has come to."""
        return {"index": self._index}

    def restore(self, memory: Mapping[str, object]) -> None:
        """Go on at that child."""
        super().restore(memory)
        self._index = cast(int, memory["index"])

    def work(self) -> Work:
        """Go on from the child that was running."""
        while self._index < len(self.children):
            status = yield from self.ticked(self.children[self._index])
            if status is not Status.SUCCESS:
                return status
            self._index += 1
        return Status.SUCCESS


class ReactiveSequence(ControlNode):
    """A sequence that begins at the first child on every tick: earlier children watch over later ones.

    When an earlier child fails or is running, later running children are halted.
    """

    def work(self) -> Work:
        """Tick from the first child on."""
        for child in self.children:
            status = yield from self.ticked(child)
            if status is not Status.SUCCESS:
                _halt_others(self, child)
                return status
        return Status.SUCCESS


def _halt_others(node: ControlNode, child: object) -> None:
    for other in node.children:
        if other is not child and other.status is Status.RUNNING:
            halt(other)
