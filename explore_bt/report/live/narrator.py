"""What a robot's tree is about, in words."""

from __future__ import annotations

import re
from dataclasses import dataclass

from explore_bt.interfaces import NodeInfo, NodeState

__all__ = ["Narrator", "Reason"]

_NUMBER = re.compile(r"[-+]?\d+(?:\.\d+)?")


@dataclass(frozen=True, slots=True)
class Reason:
    """What a leaf last said, and when it last said something new."""

    stamp_s: float
    leaf: str
    words: str


class Narrator:
    """Follows the active branch and what leaves say.

    A running leaf that only counts (``1.2 m to go``, ``1.1 m to go``) says nothing new: its words are
    brought up to date where they stand.
    """

    def __init__(self, nodes: tuple[NodeInfo, ...]) -> None:
        self._infos = nodes
        self._states: tuple[NodeState, ...] = ()
        self._reasons: dict[int, Reason] = {}
        self._shapes: dict[int, str] = {}

    def on_tick(self, stamp_s: float, nodes: tuple[NodeState, ...]) -> None:
        """Take in the tree after a tick."""
        before = self._states if len(self._states) == len(nodes) else (NodeState("idle", ""),) * len(nodes)
        for index, (old, new) in enumerate(zip(before, nodes, strict=True)):
            if new is not old and new.message and new.message != old.message:
                self._hear(stamp_s, index, new)
        self._states = nodes

    def _hear(self, stamp_s: float, index: int, state: NodeState) -> None:
        words = state.message
        shape = _NUMBER.sub("#", words)
        said = self._reasons.get(index)
        if said is not None and state.status == "running" and self._shapes[index] == shape:
            self._reasons[index] = Reason(said.stamp_s, said.leaf, words)
            return
        self._reasons.pop(index, None)  # so that it goes to the end
        self._shapes[index] = shape
        self._reasons[index] = Reason(stamp_s, self._infos[index].name, words)

    def branch(self) -> list[tuple[NodeInfo, NodeState]]:
        """Running nodes from the root to the leaf that is at work; empty between missions."""
        branch: list[tuple[NodeInfo, NodeState]] = []
        for info, state in zip(self._infos, self._states, strict=False):
            expected = branch[-1][0].id if branch else None
            if state.status == "running" and info.parent == expected:
                branch.append((info, state))
        return branch

    def reasons(self, most: int) -> list[Reason]:
        """The newest reasons, newest first."""
        return list(reversed(self._reasons.values()))[:most]

    def newest(self) -> str:
        """The newest reason with its leaf, or what is running, or nothing."""
        if self._reasons:
            reason = next(reversed(self._reasons.values()))
            return f"{reason.leaf}: {reason.words}"
        branch = self.branch()
        return branch[-1][0].name if branch else ""
