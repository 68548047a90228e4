"""A built tree as BehaviorTree.CPP writes its own: every node with its number, one block a subtree."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from xml.etree.ElementTree import Element, SubElement, indent, tostring

from explore_bt.interfaces import NodeInfo
from explore_bt.mission.btcpp.vocabulary import ENTRY_HOLDS, LIVE_TAGS
from explore_bt.mission.btcpp.write import UNPRINTABLE, control_attributes, milliseconds, port_attributes
from explore_bt.mission.nodes import Condition, NodeSpec

__all__ = ["live_attributes", "live_tree_xml", "uid_of"]


def uid_of(node: NodeInfo) -> int:
    """The number of a node in XML, status lists and logs: from 1 on."""
    return node.id + 1


def live_tree_xml(
    nodes: Sequence[NodeInfo], attributes: Mapping[str, Mapping[str, str]] | None = None
) -> str:
    """The XML that Groot2 is given for a running or recorded tree.

    A subtree that is used twice is written twice, in the order in which its nodes are numbered.

    Args:
        nodes: as in ``RunInfo.trees``.
        attributes: path -> ports and settings of that node, see ``live_attributes``.
    """
    given = attributes or {}
    document = Element("root", BTCPP_format="4", main_tree_to_execute=nodes[0].name)
    holders: dict[int, Element] = {}
    main = SubElement(document, "BehaviorTree", ID=nodes[0].name, _fullpath="")
    for node in nodes:
        holder = main if node.parent is None else holders[node.parent]
        element = SubElement(holder, LIVE_TAGS.get(node.type, node.type))
        if node.type == "subtree":
            known = given.get(node.path, {}).get("ID", node.name)
            element.attrib.update(ID=known, _fullpath=node.path, _uid=str(uid_of(node)))
            holders[node.id] = SubElement(document, "BehaviorTree", ID=known, _fullpath=node.path)
            continue
        element.attrib.update(name=node.name, _uid=str(uid_of(node)), **given.get(node.path, {}))
        holders[node.id] = element
    leaves = {node.type for node in nodes} - LIVE_TAGS.keys()
    models = SubElement(document, "TreeNodesModel")
    for leaf in sorted(leaves):
        model = SubElement(models, "Action", ID=leaf)
        ports = {name for node in nodes if node.type == leaf for name in given.get(node.path, {})}
        for port in sorted(ports):
            SubElement(model, "inout_port", name=port)
    SubElement(models, "Condition", ID=ENTRY_HOLDS)
    indent(document, "  ")
    return UNPRINTABLE.sub("\ufffd", tostring(document, encoding="unicode"))


def live_attributes(root: NodeSpec) -> dict[str, dict[str, str]]:
    """Path of a built node -> its ports and settings as attributes."""
    found: dict[str, dict[str, str]] = {}
    for node in root.walk():
        found[node.path] = port_attributes(node) if node.leaf is not None else control_attributes(node)
        modifiers = node.modifiers
        if modifiers.timeout_s is not None:
            found[f"{node.path}@timeout"] = {"msec": str(milliseconds(node))}
        if modifiers.retry is not None:
            found[f"{node.path}@retry"] = {"num_attempts": str(modifiers.retry + 1)}
        if isinstance(modifiers.condition, Condition):
            key = modifiers.condition.key
            name = f"{'not ' if modifiers.condition.negated else ''}${key}"
            found[f"{node.path}@if/{name}"] = {"entry": f"{{{key}}}"}
    return found
