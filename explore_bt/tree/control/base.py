"""Base of the control nodes: when a round begins, how children are ticked, how they are halted."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Generator, Iterator, Sequence

from py_trees.behaviour import Behaviour
from py_trees.common import Status

__all__ = ["ControlNode", "Decorator", "Work", "halt", "ticked"]

Work = Generator[Behaviour, None, Status]
"""One tick's work: yields every node it passes, returns the status."""


def ticked(child: Behaviour) -> Work:
    """Tick ``child`` and return its status."""
    yield from child.tick()
    return child.status


def halt(node: Behaviour) -> None:
    """Cut a running node off with ``stop(INVALID)``; make any other one idle.

    Unlike py_trees, ``terminate(INVALID)`` never reaches a leaf that is not running: a ``drive_to`` that
    ended long ago must not stop the wheels for whoever drives now.
    """
    if node.status is Status.RUNNING:
        node.stop(Status.INVALID)
        return
    for child in node.children:
        halt(child)
    node.status = Status.INVALID


class ControlNode(Behaviour):
    """A node that decides which of its children are ticked.

    A subclass says in ``work`` what one tick does; ``initialise`` is called before the first tick of a
    round. Statuses of the children stay visible until the next round begins.
    """

    def __init__(self, name: str, children: Sequence[Behaviour]) -> None:
        super().__init__(name=name)
        for child in children:
            child.parent = self
            self.children.append(child)

    @abstractmethod
    def work(self) -> Work:
        """Tick children as this node sees fit and return the status."""

    def tick(self) -> Iterator[Behaviour]:
        """One tick, as a generator of the nodes passed, children before parents."""
        if self.status is not Status.RUNNING:
            for child in self.children:
                halt(child)
            self.feedback_message = ""
            self.initialise()
        status = yield from self.work()
        if status is not Status.RUNNING:
            self.stop(status)
        self.status = status
        yield self

    def update(self) -> Status:
        """Unused: ``work`` takes its place."""
        return self.status

    def stop(self, new_status: Status) -> None:
        """End the round: running children are halted; on ``INVALID`` all become idle."""
        for child in self.children:
            if new_status is Status.INVALID or child.status is Status.RUNNING:
                halt(child)
        self.terminate(new_status)
        self.status = new_status

    def tip(self) -> Behaviour | None:
        """The deepest node that the last tick came to."""
        for child in reversed(self.children):
            if child.status is not Status.INVALID:
                return child.tip()
        return super().tip()


class Decorator(ControlNode):
    """A control node with one child."""

    def __init__(self, name: str, child: Behaviour) -> None:
        super().__init__(name, [child])
        self.child = child
