"""What a changed parameter changes: two readings of one mission compared."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, fields

from explore_bt.interfaces import PluginOptions
from explore_bt.mission import Condition, Mission, NodeSpec, RobotSpec
from explore_bt.tree import MockedLeaf

__all__ = ["Use", "uses"]


@dataclass(frozen=True, slots=True)
class Use:
    """One thing that differs.

    Attributes:
        what: in words.
        robot: whose.
        before, after: the node, where it is one whose values alone differ; else None: such a thing is made
            when the run begins and cannot be changed any more.
    """

    what: str
    robot: str = ""
    before: NodeSpec | None = None
    after: NodeSpec | None = None

    @property
    def can_change(self) -> bool:
        """Whether it can be changed in a run."""
        return self.after is not None


def uses(before: Mission, after: Mission) -> list[Use]:
    """Everything but the parameter itself that is not the same in both."""
    found = [
        Use(
            f"limits.{field.name.rpartition('_')[0]}"
        )  # the field carries the unit, the mission's key does not
        for field in fields(before.limits)
        if getattr(before.limits, field.name) != getattr(after.limits, field.name)
    ]
    found += [
        Use(f"tick.{rate.partition('_')[0]}")
        for rate in ("tree_rate_hz", "control_rate_hz")
        if getattr(before, rate) != getattr(after, rate)
    ]
    for old, new in zip(before.robots, after.robots, strict=True):
        found += _of_robot(old, new)
    return found


def _of_robot(before: RobotSpec, after: RobotSpec) -> Iterator[Use]:
    for field, key in (("start", "start"), ("knows_start", "start"), ("saved_map", "map")):
        if getattr(before, field) != getattr(after, field):
            yield Use(f"{key} of robot {before.name}", before.name)
    for kind in ("driver", "slam", "planner", "controller"):
        old, new = getattr(before, kind), getattr(after, kind)
        if old.name != new.name:
            yield Use(f"the {kind} of robot {before.name}", before.name)
        elif old.options != new.options:
            names = _different(old.options, new.options)
            yield Use(f"option {', '.join(names)} of {kind} {old.name}", before.name)
    yield from _of_node(before.name, before.tree, after.tree)


def _different(before: PluginOptions, after: PluginOptions) -> list[str]:
    return [name for name in type(before).model_fields if getattr(before, name) != getattr(after, name)]


def _of_node(robot: str, before: NodeSpec, after: NodeSpec) -> Iterator[Use]:
    if _shape(before) != _shape(after):
        yield Use(f"which nodes there are at {before.path}", robot)
        return
    if before.settings != after.settings:
        only_times = before.type == "repeat" and "forever" not in (
            before.settings["times"],
            after.settings["times"],
        )
        what = f"{', '.join(before.settings)} of {before.path}"
        yield Use(what, robot, before, after) if only_times else Use(what, robot)
    ports = [
        port for port in {**before.bindings, **after.bindings} if _port(before, port) != _port(after, port)
    ]
    if ports:
        yield Use(f"{', '.join(ports)} of {before.path}", robot, before, after)
    old, new = before.modifiers, after.modifiers
    for name, differs in (("timeout", old.timeout_s != new.timeout_s), ("retry", old.retry != new.retry)):
        if differs:
            yield Use(f"{name} of {before.path}", robot, before, after)
    for one, other in zip(_below(before), _below(after), strict=True):
        yield from _of_node(robot, one, other)


def _port(node: NodeSpec, port: str) -> tuple[bool, object]:
    return (port in node.bindings, node.bindings.get(port))


def _shape(node: NodeSpec) -> tuple[object, ...]:
    """What decides which nodes are built."""
    modifiers = node.modifiers
    condition = modifiers.condition
    return (
        node.type,
        node.path,
        _played_by(node),
        modifiers.timeout_s is None,
        modifiers.retry is None,
        (condition.key, condition.negated) if isinstance(condition, Condition) else None,
        len(_below(node)),
    )


def _played_by(node: NodeSpec) -> object:
    """The leaf; for a mocked one, whose class is made anew with every reading, its script."""
    leaf = node.leaf
    return leaf.script if leaf is not None and issubclass(leaf, MockedLeaf) else leaf


def _below(node: NodeSpec) -> list[NodeSpec]:
    attached = (node.modifiers.condition, node.modifiers.on_failure)
    return [*node.children, *(each for each in attached if isinstance(each, NodeSpec))]
