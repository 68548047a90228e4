"""Options out of a file of ``ros__parameters``, Nav2's for example."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import yaml
from pydantic import ValidationError

from explore_bt.errors import PluginError
from explore_bt_ros2.options import Ros2Options

__all__ = ["with_parameters"]

_OWN = "explore_bt"
_NAMES = {
    "use_sim_time": "use_sim_time",
    "robot_base_frame": "base_frame",
    "base_frame_id": "base_frame",
    "base_frame": "base_frame",
    "odom_frame_id": "odom_frame",
    "odom_frame": "odom_frame",
    "global_frame_id": "map_frame",
    "map_frame": "map_frame",
    "odom_topic": "odom_topic",
    "scan_topic": "scan_topic",
    "robot_radius": "radius",
    "enable_stamped_cmd_vel": "stamped",
}
"""Names that Nav2's and slam_toolbox's nodes use, and ours."""
_SMOOTHER = {"max_velocity": ("speed", "turn_rate"), "max_accel": ("acceleration", "turn_acceleration")}
"""Of Nav2's velocity smoother: x, y and turning."""


def with_parameters(options: Ros2Options) -> Ros2Options:
    """The options, with what the file says where the mission says nothing.

    Of all nodes' parameters those count whose meaning is known; a node ``explore_bt`` may set every option.

    Raises:
        PluginError: the file cannot be read, two nodes disagree, or a value does not fit.
    """
    path = options.parameters
    if path is None:
        return options
    found: dict[str, tuple[str, Any]] = {}
    for node, name, value in _settings(path):
        known = found.setdefault(name, (node, value))
        if known[1] != value and name not in options.model_fields_set:
            if _OWN in (node, known[0]):
                found[name] = (node, value) if node == _OWN else known
                continue
            raise PluginError(
                f"{path}: {known[0]} has {name} {known[1]!r}, {node} has {value!r}; write the one that holds "
                f"into the mission: driver: {{use: ros2, {name}: ...}}"
            )
    news = {name: value for name, (_, value) in found.items() if name not in options.model_fields_set}
    given = {name: getattr(options, name) for name in options.model_fields_set}
    try:
        return Ros2Options.model_validate({**news, **given})
    except ValidationError as fault:
        first = fault.errors()[0]
        name = str(first["loc"][0]) if first["loc"] else "?"
        raise PluginError(f"{path}: {name}: {first['msg']}, found {first['input']!r}") from None


def _settings(path: Path) -> Iterator[tuple[str, str, Any]]:
    """Node, option and value of everything that is known."""
    try:
        whole = yaml.safe_load(path.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, yaml.YAMLError) as error:
        raise PluginError(f"{path}: cannot be read as a file of ros__parameters: {error}") from None
    nodes = list(_nodes(whole, ""))
    if not nodes:
        raise PluginError(f"{path}: there is no ros__parameters in it; expected NODE: ros__parameters: ...")
    for node, parameters in nodes:
        for key, value in parameters.items():
            if node == _OWN:
                if key not in Ros2Options.model_fields:
                    raise PluginError(f"{path}: {_OWN} has no parameter {key}")
                yield node, key, value
            elif key in _NAMES:
                yield node, _NAMES[key], value
            elif key in _SMOOTHER and isinstance(value, list) and len(value) == 3:
                for name, part in zip(_SMOOTHER[key], (value[0], value[2]), strict=True):
                    yield node, name, float(part)


def _nodes(tree: Any, name: str) -> Iterator[tuple[str, dict[str, Any]]]:
    """Every node's name and parameters; nodes may lie below namespaces."""
    if not isinstance(tree, dict):
        return
    for key, below in tree.items():
        if key == "ros__parameters" and isinstance(below, dict):
            yield name, below
        else:
            yield from _nodes(below, str(key))
