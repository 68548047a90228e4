"""A behaviour tree as the mission describes it: checked, resolved, not built."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

from explore_bt.mission.source import Place
from explore_bt.tree import Leaf

__all__ = ["CONTROL_NODES", "MODIFIERS", "Condition", "Modifiers", "NodeSpec"]

CONTROL_NODES: Mapping[str, str] = {
    "sequence": "all children, one after the other; fails with the first that fails",
    "fallback": "children in order until one succeeds",
    "reactive_sequence": "a sequence that begins at its first child on every tick",
    "reactive_fallback": "a fallback that begins at its first child on every tick",
    "parallel": "all children in every tick, until enough have succeeded or failed",
    "repeat": "its child again and again while it succeeds",
    "invert": "success for failure and failure for success",
    "force_success": "success, however its child ends",
    "force_failure": "failure, however its child ends",
    "subtree": "another tree of the mission, over the same blackboard",
}
"""YAML key -> what it does."""

MODIFIERS: Mapping[str, str] = {
    "name": "what people call the node; part of its path",
    "doc": "why it is there",
    "timeout": "each attempt is cut off and fails after this much mission time",
    "retry": "how many more attempts a failing node gets, within the same tick",
    "on_failure": "a node to run after the last attempt failed; the node fails all the same",
    "if": "a node or $entry (or: not $entry), asked when a round begins; if it fails, so does the node",
}
"""Modifier -> what it does. From the inside out: timeout, retry, on_failure, if."""


LeafClass = type[Leaf]


@dataclass(frozen=True, slots=True)
class Condition:
    """``if:`` on a blackboard entry."""

    key: str
    negated: bool
    place: Place


@dataclass(frozen=True, slots=True)
class Modifiers:
    """What is wrapped around a node; see ``MODIFIERS`` for meaning and order."""

    timeout_s: float | None = None
    retry: int | None = None
    on_failure: NodeSpec | None = None
    condition: NodeSpec | Condition | None = None


@dataclass(frozen=True, slots=True)
class NodeSpec:
    """A node.

    Attributes:
        type: the YAML key (``sequence``, ``drive_to``).
        path: unique, from the root: ``complete/explore/drive_to``.
        place: where its type key stands.
        leaf: the class, None for control nodes.
        bindings: port -> constant in SI, or ``Key``; only those that the mission gives.
        places: port -> where its value stands.
        settings: a control node's own (``success``, ``failure``, ``times``, ``tree``).
    """

    type: str
    name: str
    path: str
    place: Place
    doc: str = ""
    leaf: LeafClass | None = None
    bindings: Mapping[str, object] = field(default_factory=dict)
    places: Mapping[str, Place] = field(default_factory=dict)
    settings: Mapping[str, object] = field(default_factory=dict)
    children: tuple[NodeSpec, ...] = ()
    modifiers: Modifiers = Modifiers()

    def walk(self) -> Iterator[NodeSpec]:
        """This node and all below it, those of modifiers included, depth first."""
        yield self
        attached = (self.modifiers.condition, self.modifiers.on_failure)
        for node in (*self.children, *attached):
            if isinstance(node, NodeSpec):
                yield from node.walk()
