"""A checked tree as BehaviorTree.CPP 4 XML that ticks the same way there."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from collections.abc import Set as AbstractSet
from xml.etree.ElementTree import Comment, Element, SubElement, indent, tostring

from explore_bt.errors import UserError
from explore_bt.mission.btcpp.attributes import attribute_text
from explore_bt.mission.btcpp.models import node_models
from explore_bt.mission.btcpp.vocabulary import (
    BUILTIN_TAGS,
    ENTRY_HOLDS,
    LIVE_TAGS,
    MODIFIER,
    OWN_NAME,
)
from explore_bt.mission.nodes import Condition, NodeSpec
from explore_bt.tree import Key, Leaf

__all__ = ["UNPRINTABLE", "control_attributes", "milliseconds", "port_attributes", "tree_xml"]

_ROUNDING = 1e-6
UNPRINTABLE = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
"""A character that no XML may hold."""


def tree_xml(root: NodeSpec, leaves: Iterable[type[Leaf]] = ()) -> str:
    """The tree with its subtrees, and models of its leaves.

    Modifiers become decorators and compositions of the same meaning, from the inside out ``Timeout``,
    ``RetryUntilSuccessful``, ``Fallback`` with ``ForceFailure`` around the handler, ``Sequence`` with the
    condition first. What has no twin is said in a comment at the top.

    Args:
        root: of a robot's tree.
        leaves: more leaves to describe, for an editor's palette.

    Raises:
        UserError: a value that XML cannot hold.
    """
    used = {node.leaf for node in root.walk() if node.leaf is not None} | set(leaves)
    text = _Writer(root, used).text()
    found = UNPRINTABLE.search(text)
    if found:
        raise UserError(
            f"the tree {root.name} holds the character {found[0]!r}, which XML cannot; take it out"
        )
    return f'<?xml version="1.0" encoding="UTF-8"?>\n{text}\n'


def _remarks(root: NodeSpec) -> Iterator[str]:
    nodes = list(root.walk())
    yield "Written by explore-bt. Ticks the same in BehaviorTree.CPP 4 (tickOnce, tickWhileRunning), where"
    yield "the nodes below TreeNodesModel are registered. Values are SI; parameters stand as their values."
    if any(isinstance(node.modifiers.condition, Condition) for node in nodes):
        yield f"{ENTRY_HOLDS} has no twin there: register a condition that succeeds if its entry is written"
        yield "and is neither None, false, zero nor empty."
    if any(abs(milliseconds(node) - _exact_milliseconds(node)) > _ROUNDING for node in nodes):
        yield "Timeout knows whole milliseconds, 1 at least; times in between were rounded."
    keys = {bound.name for node in nodes for bound in node.bindings.values() if isinstance(bound, Key)}
    if any(key.startswith("_") for key in keys):
        yield "Entries that begin with _ are private to each subtree there; here subtrees share them."


def _exact_milliseconds(node: NodeSpec) -> float:
    return (node.modifiers.timeout_s or 0.0) * 1000.0


def milliseconds(node: NodeSpec) -> int:
    """The time limit as ``Timeout`` takes it: whole milliseconds, 1 at least; 0 without one."""
    exact = _exact_milliseconds(node)
    return max(1, round(exact)) if exact else 0


class _Writer:
    """Writes one document; knows by which ID each tree goes in it."""

    def __init__(self, root: NodeSpec, leaves: set[type[Leaf]]) -> None:
        self._root = root
        self._leaves = leaves
        self._tops: dict[str, NodeSpec] = {}
        for node in root.walk():
            if node.type == "subtree":
                self._tops.setdefault(str(node.settings["tree"]), node.children[0])
        taken = BUILTIN_TAGS | {ENTRY_HOLDS} | {leaf.type_key for leaf in leaves}
        self._ids: dict[str, str] = {}
        for name in self._tops:
            self._ids[name] = _free(name, taken | set(self._ids.values()) | (self._tops.keys() - {name}))
        self._main = _free(root.name, taken | set(self._ids.values()))

    def text(self) -> str:
        document = Element("root", BTCPP_format="4", main_tree_to_execute=self._main)
        document.append(Comment("\n".join(["", *(f"  {line}" for line in _remarks(self._root)), ""])))
        tree = SubElement(document, "BehaviorTree", ID=self._main)
        # read back, a nameless root is called like its tree, not like its type
        tree.append(self._wrapped(self._root, self._root.type if self._main == self._root.type else ""))
        for name, top in self._tops.items():
            tree = SubElement(document, "BehaviorTree", ID=self._ids[name])
            if self._ids[name] != name:
                tree.set(OWN_NAME, name)
            tree.append(self._below(top))
        document.append(node_models(self._leaves))
        indent(document, "  ")
        return tostring(document, encoding="unicode")

    def _below(self, node: NodeSpec) -> Element:
        """A node that is not the root."""
        return self._wrapped(node, str(node.settings["tree"]) if node.type == "subtree" else node.type)

    def _wrapped(self, node: NodeSpec, default_name: str) -> Element:
        """A node with its modifiers around it."""
        element, modifiers = self._bare(node, default_name), node.modifiers
        if modifiers.timeout_s is not None:
            element = _around("Timeout", element, msec=str(milliseconds(node)))
        if modifiers.retry is not None:
            element = _around("RetryUntilSuccessful", element, num_attempts=str(modifiers.retry + 1))
        if modifiers.on_failure is not None:
            failing = _around("ForceFailure", self._below(modifiers.on_failure))
            marks = {"name": "on failure", MODIFIER: "on_failure"}
            element = _around("Fallback", element, failing, **marks)
        if modifiers.condition is not None:
            asked = self._condition(modifiers.condition)
            element = _around("Sequence", asked, element, **{"name": "if", MODIFIER: "if"})
        return element

    def _condition(self, condition: NodeSpec | Condition) -> Element:
        if isinstance(condition, NodeSpec):
            return self._below(condition)
        asked = Element(ENTRY_HOLDS, entry=f"{{{condition.key}}}")
        return _around("Inverter", asked) if condition.negated else asked

    def _bare(self, node: NodeSpec, default_name: str) -> Element:
        if node.type == "subtree":
            element = Element("SubTree", ID=self._ids[str(node.settings["tree"])], _autoremap="true")
        else:
            element = Element(node.type) if node.leaf is not None else _control(node)
            element.extend(self._below(child) for child in node.children)
        if node.name != default_name:
            element.set(OWN_NAME if node.type == "subtree" else "name", node.name)
        if node.doc:
            element.set("_description", node.doc)
        element.attrib.update(port_attributes(node))
        return element


def _free(name: str, taken: AbstractSet[str]) -> str:
    while name in taken:
        name += "_tree"
    return name


def _around(tag: str, *children: Element, **attributes: str) -> Element:
    element = Element(tag, attributes)
    element.extend(children)
    return element


def control_attributes(node: NodeSpec) -> dict[str, str]:
    """What a control node is set to, in BehaviorTree.CPP's words."""
    settings = node.settings
    if node.type == "parallel":
        success = "-1" if settings["success"] == "all" else str(settings["success"])
        return {"success_count": success, "failure_count": str(settings["failure"])}
    if node.type == "repeat":
        return {"num_cycles": "-1" if settings["times"] == "forever" else str(settings["times"])}
    return {"ID": str(settings["tree"])} if node.type == "subtree" else {}


def port_attributes(node: NodeSpec) -> dict[str, str]:
    """A leaf's ports as far as the mission binds them.

    Raises:
        UserError: a port whose name or value no attribute can have.
    """
    return {port: _port_text(node, port, bound) for port, bound in node.bindings.items()}


def _control(node: NodeSpec) -> Element:
    if node.type == "repeat" and node.settings["times"] == "forever":
        return Element("KeepRunningUntilFailure")  # unlike Repeat, it ends the tick after each round
    return Element(LIVE_TAGS[node.type], control_attributes(node))


def _port_text(node: NodeSpec, port: str, bound: object) -> str:
    if port in ("name", "ID") or port.startswith("_"):
        raise UserError(
            f"{node.place}: {node.type} has a port {port}, a name that BehaviorTree.CPP keeps for itself"
        )
    try:
        return attribute_text(bound)
    except ValueError as odd:
        place = node.places.get(port, node.place)
        raise UserError(
            f"{place}: {port}: {odd} cannot be written as an XML attribute; give it another value"
        ) from None
