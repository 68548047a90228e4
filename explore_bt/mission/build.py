"""Checked tree -> py_trees tree."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, cast

from py_trees.behaviour import Behaviour

from explore_bt.interfaces import NodeInfo, PortInfo, RobotServices
from explore_bt.mission.bounds import dimension_of
from explore_bt.mission.nodes import Condition, NodeSpec
from explore_bt.mission.source import Place
from explore_bt.mission.words import quantity, show
from explore_bt.tree import (
    Blackboard,
    EntryCondition,
    Fallback,
    ForceFailure,
    ForceSuccess,
    Guard,
    Invert,
    Key,
    Leaf,
    MockedLeaf,
    OnFailure,
    Parallel,
    ReactiveFallback,
    ReactiveSequence,
    Repeat,
    Retry,
    Subtree,
    Timeout,
)
from explore_bt.tree import Sequence as SequenceNode

__all__ = ["BuiltTree", "build_tree"]

_LISTS: Mapping[str, Callable[[str, Sequence[Behaviour]], Behaviour]] = {
    "sequence": SequenceNode,
    "fallback": Fallback,
    "reactive_sequence": ReactiveSequence,
    "reactive_fallback": ReactiveFallback,
}
_DECORATORS: Mapping[str, Callable[[str, Behaviour], Behaviour]] = {
    "invert": Invert,
    "force_success": ForceSuccess,
    "force_failure": ForceFailure,
    "subtree": Subtree,
}


@dataclass(frozen=True, slots=True, eq=False)
class BuiltTree:
    """A tree ready to be ticked.

    Attributes:
        nodes: depth first, parents before children; modifiers are nodes of their own.
        infos: one for each node, in the same order.
    """

    root: Behaviour
    nodes: tuple[Behaviour, ...]
    infos: tuple[NodeInfo, ...]


def build_tree(spec: NodeSpec, robot: RobotServices, blackboard: Blackboard) -> BuiltTree:
    """Make the nodes of one robot's tree; time limits count that robot's mission time.

    A modifier becomes a node around the one it belongs to, at the path ``node@modifier``; from the inside
    out ``timeout``, ``retry``, ``on_failure``, ``if``. Each attempt of a ``retry`` has the whole timeout.
    """
    builder = _Builder(robot, blackboard)
    root = builder.build(spec)
    nodes = tuple(_depth_first(root))
    ids = {id(node): index for index, node in enumerate(nodes)}
    infos = tuple(
        NodeInfo(
            index,
            builder.known[id(node)].path,
            node.name,
            builder.known[id(node)].type,
            ids[id(node.parent)] if node.parent is not None else None,
            str(builder.known[id(node)].place),
            _ports(node) if isinstance(node, Leaf) else (),
            isinstance(node, MockedLeaf),
        )
        for index, node in enumerate(nodes)
    )
    return BuiltTree(root, nodes, infos)


def _ports(leaf: Leaf) -> tuple[PortInfo, ...]:
    def told(bound: object, type_: Any) -> str:
        return show(bound) if isinstance(bound, Key) else quantity(bound, dimension_of(type_))

    inputs = (PortInfo(name, told(leaf.bindings[name], p.type), False) for name, p in leaf.inputs.items())
    outputs = (PortInfo(name, told(leaf.bindings[name], p.type), True) for name, p in leaf.outputs.items())
    return (*inputs, *outputs)


def _depth_first(node: Behaviour) -> list[Behaviour]:
    return [node, *(below for child in node.children for below in _depth_first(child))]


@dataclass(frozen=True, slots=True)
class _Known:
    path: str
    type: str
    place: Place


class _Builder:
    def __init__(self, robot: RobotServices, blackboard: Blackboard) -> None:
        self._robot = robot
        self._blackboard = blackboard
        self.known: dict[int, _Known] = {}

    def build(self, spec: NodeSpec) -> Behaviour:
        """The node with its modifiers around it."""
        node = self._note(self._bare(spec), spec.path, spec.type, spec.place)
        return self._guarded(spec, self._recovering(spec, self._limited(spec, node)))

    def _note(self, node: Behaviour, path: str, type_: str, place: Place) -> Behaviour:
        self.known[id(node)] = _Known(path, type_, place)
        return node

    def _bare(self, spec: NodeSpec) -> Behaviour:
        if spec.leaf is not None:
            return spec.leaf(spec.name, self._robot, self._blackboard, spec.bindings)
        children = [self.build(child) for child in spec.children]
        if spec.type in _LISTS:
            return _LISTS[spec.type](spec.name, children)
        if spec.type == "parallel":
            success, failure = spec.settings["success"], cast(int, spec.settings["failure"])
            return Parallel(spec.name, children, None if success == "all" else cast(int, success), failure)
        if spec.type == "repeat":
            times = spec.settings["times"]
            return Repeat(spec.name, children[0], None if times == "forever" else cast(int, times))
        return _DECORATORS[spec.type](spec.name, children[0])

    def _limited(self, spec: NodeSpec, node: Behaviour) -> Behaviour:
        modifiers = spec.modifiers
        if modifiers.timeout_s is not None:
            name = f"timeout {modifiers.timeout_s:g} s"
            node = Timeout(name, node, modifiers.timeout_s, self._robot.now_s)
            self._note(node, f"{spec.path}@timeout", "timeout", spec.place)
        if modifiers.retry is not None:
            node = Retry(f"retry {modifiers.retry}", node, modifiers.retry)
            self._note(node, f"{spec.path}@retry", "retry", spec.place)
        return node

    def _recovering(self, spec: NodeSpec, node: Behaviour) -> Behaviour:
        handler = spec.modifiers.on_failure
        if handler is None:
            return node
        path = f"{spec.path}@on_failure"
        failing = ForceFailure("then fail", self.build(handler))
        self._note(failing, f"{path}@fail", "force_failure", handler.place)
        return self._note(OnFailure("on failure", node, failing), path, "on_failure", spec.place)

    def _guarded(self, spec: NodeSpec, node: Behaviour) -> Behaviour:
        condition = spec.modifiers.condition
        if condition is None:
            return node
        path = f"{spec.path}@if"
        asked: Behaviour
        if isinstance(condition, Condition):
            name = f"{'not ' if condition.negated else ''}${condition.key}"
            asked = EntryCondition(name, self._blackboard, condition.key, condition.negated)
            self._note(asked, f"{path}/{name}", "entry", condition.place)
        else:
            asked = self.build(condition)
        return self._note(Guard("if", asked, node), path, "if", spec.place)
