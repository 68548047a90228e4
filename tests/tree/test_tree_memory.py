from __future__ import annotations

import zlib
from collections.abc import Mapping

from hypothesis import given
from hypothesis import strategies as st
from py_trees.behaviour import Behaviour
from py_trees.common import Status

from explore_bt.checkpoint import Codec
from explore_bt.testing.fake_robot import FakeRobot, open_floor
from explore_bt.tree import (
    Blackboard,
    Fallback,
    Invert,
    Leaf,
    Parallel,
    ReactiveFallback,
    ReactiveSequence,
    Repeat,
    Retry,
    Sequence,
    Timeout,
    restore_tree,
    tick,
    tree_memory,
)

ANSWERS = (Status.SUCCESS, Status.FAILURE, Status.RUNNING)


class Time:
    """How many ticks have passed; what leaves answer depends on it and on nothing they remember."""

    def __init__(self, ticks: int = 0) -> None:
        self.ticks = ticks

    def now_s(self) -> float:
        return float(self.ticks)


class Oracle(Behaviour):
    def __init__(self, name: str, time: Time) -> None:
        super().__init__(name)
        self._time = time

    def update(self) -> Status:
        return ANSWERS[zlib.crc32(f"{self.name} {self._time.ticks}".encode()) % 3]


Shape = tuple[str, tuple["Shape", ...]]

shapes: st.SearchStrategy[Shape] = st.recursive(
    st.just(("leaf", ())),
    lambda inner: st.one_of(
        st.tuples(
            st.sampled_from(["sequence", "fallback", "reactive_sequence", "reactive_fallback", "all", "any"]),
            st.lists(inner, min_size=1, max_size=3).map(tuple),
        ),
        st.tuples(st.sampled_from(["repeat", "for ever", "retry", "timeout", "invert"]), st.tuples(inner)),
    ),
    max_leaves=10,
)


def grow(shape: Shape, time: Time, path: str = "root") -> tuple[Behaviour, dict[str, Behaviour]]:
    kind, below = shape
    grown = [grow(each, time, f"{path}/{index}") for index, each in enumerate(below)]
    children = [node for node, _ in grown]
    node: Behaviour
    if kind == "leaf":
        node = Oracle(path, time)
    elif kind in ("all", "any"):
        node = Parallel(path, children, None if kind == "all" else 1, len(children))
    elif kind in ("repeat", "for ever"):
        node = Repeat(path, children[0], 3 if kind == "repeat" else None)
    elif kind == "retry":
        node = Retry(path, children[0], 2)
    elif kind == "timeout":
        node = Timeout(path, children[0], 4.0, time.now_s)
    elif kind == "invert":
        node = Invert(path, children[0])
    else:
        lists = {
            "sequence": Sequence,
            "fallback": Fallback,
            "reactive_sequence": ReactiveSequence,
            "reactive_fallback": ReactiveFallback,
        }
        node = lists[kind](path, children)
    return node, {path: node} | {key: each for _, nodes in grown for key, each in nodes.items()}


def answers(root: Behaviour, time: Time, until: int) -> list[Status]:
    found = []
    while time.ticks < until:
        for _ in tick(root):
            pass
        found.append(root.status)
        time.ticks += 1
    return found


@given(shapes, st.integers(0, 15))
def test_a_restored_tree_answers_as_the_one_that_was_never_cut(shape: Shape, cut: int) -> None:
    time = Time()
    root, nodes = grow(shape, time)
    answers(root, time, cut)
    text = Codec(()).dumps(tree_memory(nodes))  # as a checkpoint has it
    again_time = Time(cut)
    again, again_nodes = grow(shape, again_time)
    restore_tree(again_nodes, Codec(()).loads(text))
    assert answers(again, again_time, 30) == answers(root, time, 30)


class Counting(Leaf):
    """Counts its rounds over restarts, and its ticks within one."""

    type_key = "counting"
    keeps = ("rounds",)

    rounds = 0

    def initialise(self) -> None:
        self.rounds += 1
        self.ticks = 0

    def update(self) -> Status:
        self.ticks += 1
        return Status.RUNNING


def counting() -> Counting:
    return Counting("counting", FakeRobot(open_floor()), Blackboard())


def test_a_leaf_finds_what_it_keeps_and_begins_its_round_anew() -> None:
    leaf, restored = counting(), counting()
    for _ in range(3):
        leaf.tick_once()
    memory: Mapping[str, Mapping[str, object]] = tree_memory({"a": leaf})
    restore_tree({"a": restored}, memory)
    restored.tick_once()
    assert (restored.rounds, restored.ticks) == (2, 1)


def test_what_a_node_that_is_no_more_remembered_is_left_out() -> None:
    restore_tree({"a": counting()}, {"b": {"rounds": 3}})
