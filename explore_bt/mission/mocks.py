"""A mission whose leaves are in part played by scripts, for dry runs."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from pydantic import TypeAdapter

from explore_bt.mission.bounds import Asked, dimension_of
from explore_bt.mission.checking import check_value
from explore_bt.mission.document import Entry, Scalar
from explore_bt.mission.faults import Faults
from explore_bt.mission.files import read_mapping
from explore_bt.mission.mock_reader import MOCK_FORMAT, MockRule, read_rules
from explore_bt.mission.model import Mission
from explore_bt.mission.nodes import NodeSpec
from explore_bt.mission.reading import written
from explore_bt.mission.references import Scope
from explore_bt.mission.words import did_you_mean
from explore_bt.tree import Key, Output, Script, mocked
from explore_bt.types import Pose2, Waypoint
from explore_bt.units import PoseTriple

__all__ = ["with_mocks"]

_POSE: TypeAdapter[tuple[float, float, float]] = TypeAdapter(PoseTriple)


def with_mocks(mission: Mission, path: Path, environ: Mapping[str, str] | None = None) -> Mission:
    """The mission with the leaves replaced that the mock file names; its hash then counts the file too.

    Where several rules match a leaf the last one counts.

    Args:
        mission: checked.
        path: the mock file.
        environ: what ``$env.X`` means; the process's environment by default.

    Raises:
        MissionError: with every fault of the file.
    """
    faults = Faults()
    file = read_mapping(path, "the mock file", f"begin with format: {MOCK_FORMAT}", faults)
    if file is None:
        faults.raise_if_any()
    assert file is not None  # else a fault was noted
    source, root = file
    scope = Scope(mission.params, os.environ if environ is None else environ)
    rules = read_rules(root, scope, faults)
    used: set[int] = set()
    robots = tuple(
        replace(robot, tree=_Mocker(rules, used, faults).node(robot.tree)) for robot in mission.robots
    )
    leaves = [node for robot in mission.robots for node in robot.tree.walk() if node.leaf is not None]
    for index, rule in enumerate(rules):
        if index not in used:
            _note_unused(rule, leaves, faults)
    faults.raise_if_any()
    digest = hashlib.sha256(f"{mission.sha256}\n{source.text}".encode()).hexdigest()
    return replace(mission, robots=robots, sha256=digest)


def _note_unused(rule: MockRule, leaves: Sequence[NodeSpec], faults: Faults) -> None:
    if any(rule.matches(leaf.path) for leaf in leaves):
        faults.add(rule.place, f"every leaf that {rule.pattern} matches is mocked again below", "remove one")
        return
    known = dict.fromkeys([*(f"*/{leaf.name}" for leaf in leaves), *(leaf.path for leaf in leaves)])
    faults.add(rule.place, f"no leaf is at {rule.pattern}", did_you_mean(rule.pattern, known, "leaves"))


class _Mocker:
    """Puts scripts into one tree."""

    def __init__(self, rules: Sequence[MockRule], used: set[int], faults: Faults) -> None:
        self._rules = rules
        self._used = used
        self._faults = faults

    def node(self, spec: NodeSpec) -> NodeSpec:
        """A node and all below it."""
        modifiers = spec.modifiers
        condition = modifiers.condition
        return replace(
            self._leaf(spec),
            children=tuple(map(self.node, spec.children)),
            modifiers=replace(
                modifiers,
                on_failure=modifiers.on_failure and self.node(modifiers.on_failure),
                condition=self.node(condition) if isinstance(condition, NodeSpec) else condition,
            ),
        )

    def _leaf(self, spec: NodeSpec) -> NodeSpec:
        found = [index for index, rule in enumerate(self._rules) if rule.matches(spec.path)]
        if spec.leaf is None or not found:
            return spec
        self._used.add(found[-1])
        rule = self._rules[found[-1]]
        outputs = {entry.key: self._output(entry, spec) for entry in rule.outputs}
        return replace(spec, leaf=mocked(spec.leaf, Script(rule.rounds, rule.cycles, rule.say, outputs)))

    def _output(self, entry: Entry, spec: NodeSpec) -> object:
        assert spec.leaf is not None  # asked for leaves only
        ports = spec.leaf.outputs
        if entry.key not in ports:
            hint = did_you_mean(entry.key, ports, "outputs")
            self._faults.add(entry.place, f'{spec.type} has no output "{entry.key}"', hint)
            return None
        value = entry.value
        if isinstance(value, Scalar) and isinstance(value.data, Key):
            return value.data
        return self._constant(ports[entry.key], entry)

    def _constant(self, port: Output[Any], entry: Entry) -> object:
        if port.type is Waypoint:
            pose = check_value(
                lambda text: _POSE.validate_json(text, strict=True),
                entry.value,
                entry.key,
                Asked(),
                self._faults,
            )
            return Waypoint(Pose2(*pose), "mocked") if isinstance(pose, tuple) else None
        if isinstance(port.type, type) and port.type not in (bool, int, float, str):
            message = f"{entry.key}: {written(entry.value)} is no {port.type.__name__} that YAML can write"
            self._faults.add(entry.value.place, message, f"copy an entry: {entry.key}: $entry")
            return None
        adapter: TypeAdapter[object] = TypeAdapter(port.type)
        return check_value(
            lambda text: adapter.validate_json(text, strict=True),
            entry.value,
            entry.key,
            Asked(dimension_of(port.type)),
            self._faults,
        )
