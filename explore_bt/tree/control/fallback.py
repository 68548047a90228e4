"""Fallbacks: children in order until one does it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import cast

from py_trees.common import Status

from explore_bt.tree.control.base import ControlNode, Work, halt

__all__ = ["Fallback", "ReactiveFallback"]


class Fallback(ControlNode):
    """Succeeds with the first child that succeeds; fails when every child has failed.

    Has memory, as BehaviorTree.CPP's ``Fallback``: a child that has failed is not ticked again before the
    round is over.
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
            if status is not Status.FAILURE:
                return status
            self._index += 1
        return Status.FAILURE


class ReactiveFallback(ControlNode):
    """A fallback that begins at the first child on every tick: an earlier child takes over when it can.

    When an earlier child succeeds or is running, later running children are halted.
    """

    def work(self) -> Work:
        """Tick from the first child on."""
        for child in self.children:
            status = yield from self.ticked(child)
            if status is not Status.FAILURE:
                for other in self.children:
                    if other is not child and other.status is Status.RUNNING:
                        halt(other)
                return status
        return Status.FAILURE
