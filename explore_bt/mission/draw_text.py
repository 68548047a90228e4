"""A mission as text: parameters, robots, trees."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from explore_bt.mission.bounds import dimension_of
from explore_bt.mission.model import Mission, RobotSpec
from explore_bt.mission.nodes import Condition, NodeSpec
from explore_bt.mission.params import Param
from explore_bt.mission.words import pose, quantity, show
from explore_bt.tree import Input, Key, Output

__all__ = ["caption", "describe_modifiers", "describe_ports", "show_text"]


def show_text(mission: Mission) -> str:
    """The whole mission for a terminal: parameters as resolved, plugins, trees with ports."""
    lines = [f"{mission.name}  {mission.doc}".rstrip()]
    if mission.params:
        lines += ["", "params", *_params(mission)]
    for robot in mission.robots:
        lines += ["", *_robot(robot), ""]
        lines += _tree(robot.tree)
    return "\n".join(lines) + "\n"


def _params(mission: Mission) -> list[str]:
    shown = {param.name: _param(param, mission.params[param.name], mission) for param in mission.declared}
    names, values = max(map(len, shown)), max(map(len, shown.values()))
    docs = {param.name: param.doc for param in mission.declared}
    return [f"  {name:<{names}}  {value:<{values}}  {docs[name]}".rstrip() for name, value in shown.items()]


def _param(param: Param, value: object, mission: Mission) -> str:
    if value is None:
        return "not given"
    if isinstance(value, tuple) and param.type == "pose":
        return pose(*value)
    folder = mission.path.parent.absolute()
    if isinstance(value, Path) and value.is_relative_to(folder):
        return value.relative_to(folder).as_posix()
    return quantity(value, param.asked.dimension)


def _robot(robot: RobotSpec) -> Iterator[str]:
    choices = (robot.driver, robot.slam, robot.planner, robot.controller)
    yield f"robot {robot.name}  " + " · ".join(f"{choice.kind} {choice.name}" for choice in choices)
    if robot.start is not None:
        yield f"  start  {pose(robot.start.x, robot.start.y, robot.start.yaw_rad)}"
    if not robot.knows_start:
        yield "  start  unknown"
    if robot.saved_map is not None:
        yield f"  goes on in the map of {robot.saved_map}"


def _tree(root: NodeSpec) -> list[str]:
    return [caption(root), *_below(root, "")]


def _below(node: NodeSpec, indent: str) -> Iterator[str]:
    parts = [("", child) for child in node.children]
    if isinstance(node.modifiers.condition, NodeSpec):
        parts.insert(0, ("if: ", node.modifiers.condition))
    if node.modifiers.on_failure is not None:
        parts.append(("on_failure: ", node.modifiers.on_failure))
    for index, (label, child) in enumerate(parts):
        last = index == len(parts) - 1
        yield f"{indent}{'└─ ' if last else '├─ '}{label}{caption(child)}"
        yield from _below(child, indent + ("   " if last else "│  "))


def caption(node: NodeSpec) -> str:
    """One line: name, type where the name does not say it, settings, ports, modifiers."""
    head = node.name if node.name == node.type else f"{node.name}  [{node.type}]"
    settings = {key: value for key, value in node.settings.items() if key != "tree"}
    details = [f"{key} {show(value)}" for key, value in settings.items()]
    details += [*describe_ports(node), *describe_modifiers(node)]
    return "  ".join([head, *details])


def describe_ports(node: NodeSpec) -> list[str]:
    """``port=value`` as given in the mission, ``port→$entry`` for outputs."""
    if node.leaf is None:
        return []
    ports: dict[str, Input[Any] | Output[Any]] = {**node.leaf.inputs, **node.leaf.outputs}
    parts = []
    for name, bound in node.bindings.items():
        port = ports[name]
        arrow = "=" if isinstance(port, Input) else "→"
        shown = show(bound) if isinstance(bound, Key) else quantity(bound, dimension_of(port.type))
        parts.append(f"{name}{arrow}{shown}")
    return parts


def describe_modifiers(node: NodeSpec) -> list[str]:
    """``(timeout 60 s)``, ``(retry 2)``, ``(if $key)``."""
    modifiers = node.modifiers
    parts = []
    if modifiers.timeout_s is not None:
        parts.append(f"(timeout {modifiers.timeout_s:g} s)")
    if modifiers.retry is not None:
        parts.append(f"(retry {modifiers.retry})")
    if isinstance(modifiers.condition, Condition):
        parts.append(f"(if {'not ' if modifiers.condition.negated else ''}${modifiers.condition.key})")
    return parts
