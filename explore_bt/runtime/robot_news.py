"""What happens to one robot, told in lines: its health, its gate, its tree."""

from __future__ import annotations

from collections.abc import Callable

from py_trees.behaviour import Behaviour

from explore_bt.mission import BuiltTree
from explore_bt.runtime.gate_news import GateNews
from explore_bt.runtime.health_news import HealthNews
from explore_bt.runtime.pilot import Pilot
from explore_bt.runtime.tree_news import TreeNews
from explore_bt.types import Estimate, Health

__all__ = ["RobotNews"]


class RobotNews:
    """Tells what is new, as level, source and message."""

    def __init__(self, tree: BuiltTree, tell: Callable[[str, str, str], None]) -> None:
        self._tell = tell
        self._health, self._gate, self._tree = HealthNews(), GateNews(), TreeNews(tree)

    def of_health(self, estimate: Estimate, now_s: float) -> None:
        """After measurements have come in."""
        if line := self._health.of(estimate, now_s):
            self._tell("info" if estimate.health is Health.OK else "warning", "slam", line)

    def of_gate(self, pilot: Pilot, now_s: float) -> None:
        """After a control period."""
        if line := self._gate.of(pilot.gate_reason, pilot.held_by, now_s):
            self._tell("warning" if self._gate.is_held else "info", "safety gate", line)

    def of_node(self, node: Behaviour, now_s: float) -> None:
        """After a node's tick; ``now_s`` is the tree's time."""
        for line in self._tree.of(node, now_s):
            self._tell(*line)
