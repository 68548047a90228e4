"""YAML to XML and back: the same tree."""

from __future__ import annotations

import json
import tempfile
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from explore_bt.cli.places import find_mission, shipped_missions
from explore_bt.mission import Condition, NodeSpec, load_mission, load_tree
from explore_bt.mission.btcpp import read_tree_xml, tree_xml
from explore_bt.mission.source import Source
from explore_bt.plugin import Registry, load_plugins

NAMES = st.text(st.sampled_from("ab Z9-_.:;'\"<>&{}#!é☃$\n\t"), min_size=1, max_size=8).filter(str.strip)
CHARACTERS = st.characters(codec="utf-8", exclude_categories=["Cc", "Cs"], exclude_characters="\ufffe\uffff$")
TEXTS = st.text(CHARACTERS, max_size=8)
SUBTREES = ("home", "Sequence", "other tree")
"""A leaf is called like the first, and a node of BehaviorTree.CPP like the second."""
KEYS = st.sampled_from(["$goal", "$reached", "$_own"])
PORTS = st.fixed_dictionaries(
    {},
    optional={
        "half_planes": st.one_of(st.just("all"), st.integers(1, 9)),
        "stride": st.one_of(st.floats(0.1, 10.0), st.sampled_from(["30 cm", "1.5 m", 2])),
        "turn": st.one_of(st.sampled_from(["90 deg", "-1 rad"]), st.floats(-1e3, 1e3)),
        "eager": st.booleans(),
        "label": TEXTS.filter(
            lambda text: not text.startswith("$") and not (text[:1] == "{" and text[-1:] == "}")
        ),
        "weights": st.lists(st.floats(allow_nan=False, allow_infinity=False), min_size=2, max_size=3),
        "patience": st.one_of(st.none(), st.floats(0.0, 1e6), st.just("2 min")),
        "goal": KEYS,
    },
)
LEAVES = st.one_of(
    PORTS.map(lambda ports: {"look": ports}),
    KEYS.map(lambda key: {"drive": {"goal": key}}),
    st.just({"home": None}),
)


def modified(nodes: st.SearchStrategy[dict[str, Any]]) -> st.SearchStrategy[dict[str, Any]]:
    modifiers = st.fixed_dictionaries(
        {},
        optional={
            "name": NAMES,
            "doc": TEXTS.filter(bool),
            "timeout": st.integers(1, 10**7).map(lambda ms: f"{ms} ms"),
            "retry": st.integers(1, 5),
            "on_failure": LEAVES,
            "if": st.one_of(LEAVES, KEYS, KEYS.map(lambda key: f"not {key}")),
        },
    )
    return st.tuples(nodes, modifiers).map(lambda pair: {**pair[0], **pair[1]})


def control(below: st.SearchStrategy[dict[str, Any]]) -> st.SearchStrategy[dict[str, Any]]:
    lists = st.lists(below, min_size=1, max_size=3)
    parallel = lists.flatmap(
        lambda children: st.fixed_dictionaries(
            {"children": st.just(children)},
            optional={
                "success": st.one_of(st.just("all"), st.integers(1, len(children))),
                "failure": st.integers(1, len(children)),
            },
        )
    )
    kinds = ["sequence", "fallback", "reactive_sequence", "reactive_fallback"]
    one = st.sampled_from(["invert", "force_success", "force_failure"])
    return modified(
        st.one_of(
            st.tuples(st.sampled_from(kinds), lists).map(lambda pair: {pair[0]: pair[1]}),
            st.tuples(one, below).map(lambda pair: {pair[0]: pair[1]}),
            parallel.map(lambda settings: {"parallel": settings}),
            st.tuples(st.one_of(st.just("forever"), st.integers(1, 9)), below).map(
                lambda pair: {"repeat": {"times": pair[0], "child": pair[1]}}
            ),
            st.sampled_from(SUBTREES).map(lambda name: {"subtree": name}),
        )
    )


NODES = st.recursive(modified(LEAVES), control, max_leaves=10)
WRITERS = {"sequence": [{"home": None}, {"home": {"goal": "$reached"}}, {"home": {"goal": "$_own"}}]}
"""So that every entry is written by somebody."""


def bare(node: NodeSpec) -> object:
    """All of a node but where it stands in its file."""
    nowhere = Source("", "", Path()).place()
    condition = node.modifiers.condition
    if isinstance(condition, Condition):
        asked: object = replace(condition, place=nowhere)
    else:
        asked = condition and bare(condition)
    handler = node.modifiers.on_failure
    timeout = node.modifiers.timeout_s and round(node.modifiers.timeout_s, 9)  # 43 ms is not quite 0.043 s
    modifiers = (timeout, node.modifiers.retry, asked, handler and bare(handler))
    own = (node.type, node.name, node.path, node.doc, node.leaf, dict(node.bindings), dict(node.settings))
    return (*own, modifiers, [bare(child) for child in node.children])


def there_and_back(root: NodeSpec, folder: Path, leaves: Registry) -> NodeSpec:
    path = folder / "tree.xml"
    path.write_text(tree_xml(root))
    tree = read_tree_xml(path, leaves)
    again = folder / "again.yaml"
    again.write_text(tree.text)
    loaded = load_tree(again, [tree.name], leaves)
    assert bare(loaded) == bare(tree.root)
    return loaded


@settings(deadline=None, max_examples=100)
@given(main=NODES, shared=NODES.filter(lambda node: "subtree" not in str(node)))
def test_any_tree_comes_back_as_it_was(leaves: Registry, main: Any, shared: Any) -> None:
    trees = {"main": {"sequence": [WRITERS, main]}, **dict.fromkeys(SUBTREES, shared)}
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        path = folder / "trees.yaml"
        path.write_text(json.dumps({"trees": trees}, ensure_ascii=False))
        root = load_tree(path, ["main"], leaves)
        assert bare(there_and_back(root, folder, leaves)) == bare(root)


@pytest.mark.parametrize("mission", list(shipped_missions()))
@pytest.mark.parametrize("strategy", ["complete", "paper", "nearest_frontier", "information_gain", "tour"])
def test_the_trees_that_ship_come_back_as_they_were(mission: str, strategy: str, tmp_path: Path) -> None:
    if mission == "06_ros2":
        pytest.importorskip("rclpy", reason="its driver needs ROS 2: make test-ros2")
    registry = load_plugins().registry
    path = find_mission(mission)
    settings_ = {"strategy": strategy} if "strategy" in path.read_text() else {}
    root = load_mission(path, registry, settings_).robots[0].tree
    assert bare(there_and_back(root, tmp_path, registry)) == bare(root)
