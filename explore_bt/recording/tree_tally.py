"""What every node of a tree did, counted: ticks, ends, mission time."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from explore_bt.interfaces import NodeState

__all__ = ["NodeTally", "TreeTally"]


@dataclass(slots=True)
class NodeTally:
    """One node's share of a run.

    Attributes:
        ticks: how often it was ticked; 0: never.
        successes, failures: how often it ended so.
        cut_off: how often it was halted while it ran.
        running_s: mission time in which it was running.
        longest_s: the longest time from its first tick to its end.
    """

    ticks: int = 0
    successes: int = 0
    failures: int = 0
    cut_off: int = 0
    running_s: float = 0.0
    longest_s: float = 0.0


class TreeTally:
    """Counts tick by tick; mission time only, so that two equal runs count the same."""

    def __init__(self) -> None:
        self.nodes: list[NodeTally] = []
        self._begin_s: dict[int, float] = {}
        self._last_s = 0.0

    def on_tick(self, stamp_s: float, states: Sequence[NodeState]) -> None:
        """Take in the tree after a tick, its nodes in depth-first order."""
        if len(self.nodes) != len(states):
            self.nodes = [NodeTally() for _ in states]
            self._begin_s = {}
        elapsed_s, self._last_s = stamp_s - self._last_s, stamp_s
        for index, begin_s in self._begin_s.items():
            tally = self.nodes[index]
            tally.running_s += elapsed_s
            tally.longest_s = max(tally.longest_s, stamp_s - begin_s)
        ticked = [index for index, state in enumerate(states) if state.ticks]  # few of many
        for index in {*ticked, *self._begin_s}:
            self._count(index, states[index], stamp_s)

    def _count(self, index: int, state: NodeState, stamp_s: float) -> None:
        tally, ends = self.nodes[index], state.successes + state.failures
        tally.ticks += state.ticks
        tally.successes += state.successes
        tally.failures += state.failures
        begin_s = self._begin_s.pop(index, None)
        if state.status == "running":
            self._begin_s[index] = stamp_s if begin_s is None or ends else begin_s
        else:
            tally.cut_off += begin_s is not None and not ends
