"""How the nodes of a tree stand, and how often each was ticked in the present tick of the whole."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from py_trees.behaviour import Behaviour

from explore_bt.interfaces import NodeState
from explore_bt.tree import Status, status_word

__all__ = ["TickCounts"]


class TickCounts:
    """Counts the nodes as their ticks end."""

    def __init__(self, nodes: Sequence[Behaviour]) -> None:
        self._nodes = nodes
        self._counts: Counter[tuple[int, Status]] = Counter()

    def note(self, node: Behaviour) -> None:
        """A node's tick has ended."""
        self._counts[id(node), node.status] += 1

    def states(self) -> tuple[NodeState, ...]:
        """All nodes, in their order, as they are now, with what was counted since ``forget``."""
        return tuple(_state(node, self._counts) for node in self._nodes)

    def forget(self) -> None:
        """Count from nothing again."""
        self._counts.clear()


def _state(node: Behaviour, counts: Counter[tuple[int, Status]]) -> NodeState:
    successes, failures, running = (
        counts[id(node), status] for status in (Status.SUCCESS, Status.FAILURE, Status.RUNNING)
    )
    return NodeState(
        status_word(node.status), node.feedback_message, successes + failures + running, successes, failures
    )
