"""Base of the control nodes: when a round begins, how children are ticked, how they are halted."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Generator, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING

from py_trees.behaviour import Behaviour
from py_trees.common import Status

if TYPE_CHECKING:
    from explore_bt.tree.probe import Probe

__all__ = ["ControlNode", "Decorator", "Work", "halt", "ticked"]

_MOST_PASSES = 1000

Work = Generator[Behaviour, None, Status]
"""One tick's work: yields every node it passes, returns the status."""


def ticked(node: Behaviour, probe: Probe | None) -> Work:
    """Tick ``node``, unless the probe answers in its place, and return its status."""
    if probe is None:
        yield from node.tick()
        return node.status
    answer = probe.before(node)
    if answer is None:
        yield from node.tick()
    else:
        _answer(node, answer)
        yield node
    answer = probe.after(node)
    if answer is not None:
        _answer(node, answer)
    return node.status


def _answer(node: Behaviour, status: Status) -> None:
    """End the node's round with a status that is not its own."""
    if status not in (Status.SUCCESS, Status.FAILURE):
        raise ValueError(f"{status} cannot be answered for a node; answer SUCCESS or FAILURE")
    if node.status is Status.RUNNING:
        node.stop(Status.INVALID)
    node.status = status


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

    A root whose tree was woken (see ``wake``) is ticked again within the same tick, as by BehaviorTree.CPP's
    ``tickOnce``. Where that would never end, as with two endless loops side by side that wake each other, the
    tick ends after a thousand passes and goes on in the next one; BehaviorTree.CPP hangs there.

    Attributes:
        probe: asked before and after every tick of a child; None: nobody is.
    """

    probe: Probe | None = None
    _woken = False

    def __init__(self, name: str, children: Sequence[Behaviour]) -> None:
        super().__init__(name=name)
        for child in children:
            child.parent = self
            self.children.append(child)

    def ticked(self, child: Behaviour) -> Work:
        """Tick ``child`` and return its status."""
        return ticked(child, self.probe)

    def wake(self) -> None:
        """Have the whole tree ticked again, from its root, as soon as this pass through it is over."""
        root: Behaviour = self
        while root.parent is not None:
            root = root.parent
        if isinstance(root, ControlNode):
            root._woken = True

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
        for _ in range(_MOST_PASSES):
            self._woken = False
            status = yield from self.work()
            if status is not Status.RUNNING:
                self.stop(status)
            self.status = status
            yield self
            if status is not Status.RUNNING or not self._woken:
                break

    def memory(self) -> Mapping[str, object]:
        """What the running round has to remember to go on in another process; plain values."""
        return {}

    def restore(self, memory: Mapping[str, object]) -> None:  # noqa: ARG002  # most nodes remember nothing
        """Go on in the round that ``memory`` tells of; what was running below begins its own round anew."""
        self.status = Status.RUNNING

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
