"""Random trees, ticked by us and by the real BehaviorTree.CPP, leaf for leaf and tick for tick."""

from __future__ import annotations

import random
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import behaviortreepy as bt
import yaml

from explore_bt.clock import ManualClock
from explore_bt.mission import build_tree, load_tree
from explore_bt.mission.btcpp import tree_xml
from explore_bt.mission.nodes import NodeSpec
from explore_bt.plugin import Registry
from explore_bt.tree import Blackboard, Leaf, Status

Log = list[tuple[str, str]]
"""(leaf, what was answered: S, F, R; or ``halt``), in order."""

ANSWERS = {"S": Status.SUCCESS, "F": Status.FAILURE, "R": Status.RUNNING}
THEIRS = {"S": bt.NodeStatus.SUCCESS, "F": bt.NodeStatus.FAILURE, "R": bt.NodeStatus.RUNNING}
LETTERS = {status: letter for letter, status in ANSWERS.items()}
THEIR_LETTERS = {status: letter for letter, status in THEIRS.items()}


class Scripts:
    """Answers of all leaves, each its own script round and round, and the diary of one execution."""

    name = "robot"

    def __init__(self, scripts: Mapping[str, str]) -> None:
        self._scripts = scripts
        self._asked = dict.fromkeys(scripts, 0)
        self.clock = ManualClock()
        self.log: Log = []

    def now_s(self) -> float:
        return self.clock.now_s()

    def answer(self, leaf: str) -> str:
        script = self._scripts[leaf]
        letter = script[self._asked[leaf] % len(script)]
        self._asked[leaf] += 1
        self.log.append((leaf, letter))
        return letter

    def halted(self, leaf: str) -> None:
        self.log.append((leaf, "halt"))


class Scripted(Leaf):
    """Answers what its robot's script says."""

    type_key = "scripted"

    def update(self) -> Status:
        return ANSWERS[self.robot.answer(self.name)]  # type: ignore[attr-defined]  # Scripts stands in for a robot

    def terminate(self, new_status: Status) -> None:
        if new_status is Status.INVALID:
            self.robot.halted(self.name)  # type: ignore[attr-defined]  # the same


def catalog() -> Registry:
    registry = Registry()
    registry.add(Scripted, origin="test")
    return registry


class Grower:
    """Draws trees."""

    def __init__(self, seed: int, *, timeouts: bool = False) -> None:
        self._random = random.Random(seed)
        self._timeouts = timeouts
        self.scripts: dict[str, str] = {}
        self.trees: dict[str, Any] = {}

    def grow(self) -> str:
        """A file of trees; the main one is called ``main``."""
        self.trees["main"] = {"sequence": [self._node(4)]} if self._random.random() < 0.2 else self._node(5)
        return yaml.safe_dump({"format": "explore-bt/1", "trees": self.trees}, sort_keys=False)

    def _leaf(self) -> dict[str, Any]:
        name = f"L{len(self.scripts)}"
        self.scripts[name] = "".join(self._random.choices("SFR", (4, 4, 3), k=self._random.randint(1, 5)))
        return {"name": name, "scripted": {}}

    def _node(self, depth: int) -> dict[str, Any]:
        node = self._leaf() if depth == 0 or self._random.random() < 0.2 else self._control(depth - 1)
        for modifier in ("timeout", "retry", "on_failure", "if"):
            if self._random.random() < 0.08:
                self._modify(node, modifier, depth)
        return node

    def _modify(self, node: dict[str, Any], modifier: str, depth: int) -> None:
        if modifier == "timeout" and self._timeouts:
            node["timeout"] = "1 s"
        elif modifier == "retry":
            node["retry"] = self._random.randint(1, 3)
        elif modifier in ("on_failure", "if"):
            node[modifier] = self._node(min(1, max(0, depth - 1)))

    def _control(self, depth: int) -> dict[str, Any]:
        kinds = ["sequence", "fallback", "reactive_sequence", "reactive_fallback", "parallel", "parallel"]
        kinds += ["invert", "force_success", "force_failure", "subtree", "repeat"]
        kind = self._random.choice(kinds)
        if kind in ("invert", "force_success", "force_failure"):
            return {kind: self._node(depth)}
        if kind == "subtree":
            name = f"tree{len(self.trees)}"
            self.trees[name] = None  # keeps the number while what is below takes others
            self.trees[name] = self._node(depth)
            return {"subtree": name}
        if kind == "repeat":
            times = self._random.choice(["forever", 1, 2, 3])
            return {"repeat": {"times": times, "child": self._node(depth)}}
        children = [self._node(depth) for _ in range(self._random.randint(1, 3))]
        if kind != "parallel":
            return {kind: children}
        success = self._random.choice(["all", self._random.randint(1, len(children))])
        failure = self._random.randint(1, len(children))
        return {"parallel": {"success": success, "failure": failure, "children": children}}


class Ours:
    """A tree built by us."""

    def __init__(self, root: NodeSpec, scripts: Mapping[str, str]) -> None:
        self.scripts = Scripts(scripts)
        self._root = build_tree(root, self.scripts, Blackboard()).root  # type: ignore[arg-type]  # the same

    def tick(self) -> tuple[str, Log]:
        """The root's status, and what happened to the leaves."""
        self.scripts.log = []
        self._root.tick_once()
        return LETTERS[self._root.status], self.scripts.log


class Theirs:
    """The same tree, exported to XML and built by BehaviorTree.CPP."""

    def __init__(self, root: NodeSpec, scripts: Mapping[str, str]) -> None:
        self.scripts = Scripts(scripts)
        self._factory = bt.BehaviorTreeFactory()
        self._factory.register_simple_stateful_action("scripted", self._answer, self._answer, self._halted)
        self.tree = self._factory.create_tree_from_text(tree_xml(root))

    def _answer(self, node: Any) -> Any:
        return THEIRS[self.scripts.answer(node.name())]

    def _halted(self, node: Any) -> None:
        self.scripts.halted(node.name())

    def tick(self) -> tuple[str, Log]:
        """One ``tickOnce``."""
        self.scripts.log = []
        status = self.tree.tick_once()
        if status != bt.NodeStatus.RUNNING:
            self.tree.sleep(0)  # a wake-up asked for in the last pass would haunt the next round
        return THEIR_LETTERS[status], self.scripts.log


def load(text: str, folder: Path, registry: Registry) -> NodeSpec:
    path = folder / "trees.yaml"
    path.write_text(text)
    return load_tree(path, ["main"], registry)
