"""A mission's trees as a Graphviz graph."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping

from explore_bt.mission.draw_text import describe_modifiers, describe_ports
from explore_bt.mission.model import Mission
from explore_bt.mission.nodes import NodeSpec
from explore_bt.mission.words import show

__all__ = ["show_dot"]

_SYMBOLS: Mapping[str, str] = {
    "sequence": "→",
    "reactive_sequence": "→ reactive",
    "fallback": "?",
    "reactive_fallback": "? reactive",
    "parallel": "⇉",
    "repeat": "↻",
    "invert": "¬",
    "force_success": "✓",
    "force_failure": "✗",
    "subtree": "▸",
}


def show_dot(mission: Mission) -> str:
    """Text for ``dot -Tsvg``; one cluster a robot."""
    lines = [
        f"digraph {json.dumps(mission.name)} {{",
        '  node [fontname="sans-serif" fontsize=11 shape=box style=rounded];',
        "  edge [arrowhead=none];",
    ]
    for robot in mission.robots:
        lines.append(f"  subgraph {json.dumps(f'cluster_{robot.name}')} {{")
        lines.append(f"    label={json.dumps(robot.name)};")
        lines += [f"    {line}" for line in _nodes(robot.tree, robot.name)]
        lines.append("  }")
    return "\n".join([*lines, "}"]) + "\n"


def _nodes(node: NodeSpec, robot: str) -> Iterator[str]:
    identity = _identity(node, robot)
    yield f"{identity} [label={_label(node)}{'' if node.leaf else ' shape=ellipse'}];"
    attached = [("", child) for child in node.children]
    if isinstance(node.modifiers.condition, NodeSpec):
        attached.insert(0, ("if", node.modifiers.condition))
    if node.modifiers.on_failure is not None:
        attached.append(("on_failure", node.modifiers.on_failure))
    for label, child in attached:
        style = f" [style=dashed label={json.dumps(label)}]" if label else ""
        yield f"{identity} -> {_identity(child, robot)}{style};"
        yield from _nodes(child, robot)


def _identity(node: NodeSpec, robot: str) -> str:
    return json.dumps(f"{robot}:{node.path}", ensure_ascii=False)


def _label(node: NodeSpec) -> str:
    symbol = _SYMBOLS.get(node.type, "")
    head = node.name if node.name == node.type and not symbol else f"{symbol or node.type}  {node.name}"
    settings = [f"{key} {show(value)}" for key, value in node.settings.items() if key != "tree"]
    lines = [head, *settings, *describe_ports(node), *describe_modifiers(node)]
    return json.dumps("\n".join(lines), ensure_ascii=False)
