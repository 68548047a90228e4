"""Where in a tree a node is to stand."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

from explore_bt.mission.document import Value
from explore_bt.mission.nodes import NodeSpec
from explore_bt.mission.references import Scope

__all__ = ["ReadNode", "Spot"]


@dataclass(frozen=True, slots=True)
class Spot:
    """Where a node is to stand: the path above it, the trees it is inside of, and how deep it is."""

    path: str
    scope: Scope
    trees: tuple[str, ...] = ()
    depth: int = 0

    def below(self, path: str) -> Spot:
        """One level deeper."""
        return replace(self, path=path, depth=self.depth + 1)


ReadNode = Callable[[Value, Spot, set[str]], NodeSpec | None]
"""Reads one node: its value, its spot, the paths its siblings have taken."""
