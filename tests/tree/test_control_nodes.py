"""Tick tables: what scripted children answer, tick by tick, and what the control node says.

A script is one letter a tick: S success, F failure, R running. ``.`` in a table is a child that was not
ticked. Expected rows follow BehaviorTree.CPP 4.
"""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from py_trees.behaviour import Behaviour
from py_trees.common import Status

from explore_bt.clock import ManualClock
from explore_bt.tree import (
    Blackboard,
    EntryCondition,
    Fallback,
    ForceFailure,
    ForceSuccess,
    Guard,
    Invert,
    OnFailure,
    Parallel,
    ReactiveFallback,
    ReactiveSequence,
    Repeat,
    Retry,
    Sequence,
    Subtree,
    Timeout,
)

STATUS = {"S": Status.SUCCESS, "F": Status.FAILURE, "R": Status.RUNNING}
LETTER = {status: letter for letter, status in STATUS.items()} | {Status.INVALID: "-"}


class Scripted(Behaviour):
    """Answers by its script, round and round, and remembers how it was treated."""

    def __init__(self, script: str) -> None:
        super().__init__(name=script)
        self.script = script
        self.ticks = 0
        self.begun = 0
        self.log: list[str] = []
        self.row = ""

    def initialise(self) -> None:
        self.begun += 1

    def update(self) -> Status:
        answer = self.script[self.ticks % len(self.script)]
        self.ticks += 1
        self.row += answer
        return STATUS[answer]

    def terminate(self, new_status: Status) -> None:
        self.log.append(LETTER[new_status])


def play(root: Behaviour, children: list[Scripted], ticks: int) -> list[str]:
    """One row a tick: the root's status, then what each child answered (``.`` if it was not ticked)."""
    rows = []
    for _ in range(ticks):
        for child in children:
            child.row = ""
        root.tick_once()
        rows.append(" ".join([LETTER[root.status], *(child.row or "." for child in children)]))
    return rows


def scripted(*scripts: str) -> list[Scripted]:
    return [Scripted(script) for script in scripts]


TABLES = {
    "sequence: all succeed": (Sequence, ["S", "S"], ["S S S", "S S S"]),
    "sequence: goes on where it was running": (Sequence, ["S", "RS", "S"], ["R S R .", "S . S S", "R S R ."]),
    "sequence: stops at the first failure": (Sequence, ["S", "F", "S"], ["F S F .", "F S F ."]),
    "sequence: does not ask earlier children again": (Sequence, ["SF", "RS"], ["R S R", "S . S", "F F ."]),
    "fallback: first success": (Fallback, ["F", "S", "S"], ["S F S .", "S F S ."]),
    "fallback: goes on where it was running": (Fallback, ["F", "RF", "S"], ["R F R .", "S . F S"]),
    "fallback: all fail": (Fallback, ["F", "F"], ["F F F", "F F F"]),
    "reactive_sequence: asks every tick": (ReactiveSequence, ["SSF", "R"], ["R S R", "R S R", "F F ."]),
    "reactive_sequence: an earlier one runs": (ReactiveSequence, ["SR", "R"], ["R S R", "R R ."]),
    "reactive_fallback: taken over": (
        ReactiveFallback,
        ["FFS", "R"],
        ["R F R", "R F R", "S S ."],
    ),
    "reactive_fallback: all fail": (ReactiveFallback, ["F", "RF"], ["R F R", "F F F"]),
}


@pytest.mark.parametrize(("kind", "scripts", "rows"), TABLES.values(), ids=TABLES.keys())
def test_lists_tick_as_their_table_says(kind, scripts, rows) -> None:
    children = scripted(*scripts)
    assert play(kind("node", children), children, len(rows)) == rows


PARALLELS = {
    "all must succeed": (["S", "RS"], None, 1, ["R S R", "S . S"]),
    "one failure is enough": (["S", "F", "S"], None, 1, ["F S F ."]),
    "stops at its success threshold": (["S", "S", "S"], 2, 1, ["S S S ."]),
    "tolerates failures below the threshold": (["F", "RS", "RRS"], 2, 2, ["R F R R", "R . S R", "S . . S"]),
    "fails when success is out of reach": (["F", "F", "R"], 2, 3, ["F F F ."]),
    "children that have ended are not ticked": (["S", "RRS"], None, 1, ["R S R", "R . R", "S . S"]),
}


@pytest.mark.parametrize(("scripts", "success", "failure", "rows"), PARALLELS.values(), ids=PARALLELS.keys())
def test_parallel_ticks_as_its_table_says(scripts, success, failure, rows) -> None:
    children = scripted(*scripts)
    assert play(Parallel("node", children, success, failure), children, len(rows)) == rows


DECORATORS = {
    "repeat goes on within the tick": (lambda c: Repeat("n", c, 3), "S", ["S SSS", "S SSS"]),
    "repeat waits for a running child": (lambda c: Repeat("n", c, 2), "SRS", ["R SR", "S S"]),
    "repeat fails with its child": (lambda c: Repeat("n", c, 3), "SF", ["F SF"]),
    "repeat for ever yields after each round": (lambda c: Repeat("n", c, None), "S", ["R S", "R S", "R S"]),
    "repeat for ever ends with a failure": (lambda c: Repeat("n", c, None), "SSF", ["R S", "R S", "F F"]),
    "retry goes on within the tick": (lambda c: Retry("n", c, 2), "FFS", ["S FFS"]),
    "retry gives up": (lambda c: Retry("n", c, 2), "F", ["F FFF", "F FFF"]),
    "retry waits for a running child": (lambda c: Retry("n", c, 1), "FRS", ["R FR", "S S"]),
    "retry counts afresh": (lambda c: Retry("n", c, 1), "FSFFS", ["S FS", "F FF", "S S"]),
    "invert": (lambda c: Invert("n", c), "SFR", ["F S", "S F", "R R"]),
    "force_success": (lambda c: ForceSuccess("n", c), "SFR", ["S S", "S F", "R R"]),
    "force_failure": (lambda c: ForceFailure("n", c), "SFR", ["F S", "F F", "R R"]),
    "subtree": (lambda c: Subtree("n", c), "SFR", ["S S", "F F", "R R"]),
}


@pytest.mark.parametrize(("make", "script", "rows"), DECORATORS.values(), ids=DECORATORS.keys())
def test_decorators_tick_as_their_table_says(make, script, rows) -> None:
    child = Scripted(script)
    assert play(make(child), [child], len(rows)) == rows


def test_a_timeout_halts_its_child_and_fails_without_ticking_it() -> None:
    clock, child = ManualClock(), Scripted("R")
    root = Timeout("node", child, 1.0, clock.now_s)
    rows = []
    for now in (0.0, 0.5, 0.99, 1.0, 1.1):
        clock.wait_until(now)
        rows += play(root, [child], 1)
    assert rows == ["R R", "R R", "R R", "F .", "R R"]
    assert (child.log, child.begun) == (["-"], 2)
    assert root.feedback_message == ""


def test_a_child_that_ends_in_time_knows_no_timeout() -> None:
    clock, child = ManualClock(), Scripted("RS")
    root = Timeout("node", child, 1.0, clock.now_s)
    assert play(root, [child], 1) == ["R R"]
    clock.wait_until(0.9)
    assert play(root, [child], 1) == ["S S"]


def test_a_guard_asks_once_a_round() -> None:
    condition, child = scripted("SF", "RS")
    root = Guard("if", condition, child)
    assert play(root, [condition, child], 3) == ["R S R", "S . S", "F F ."]


def test_on_failure_runs_its_handler_and_fails_all_the_same() -> None:
    child, handler = scripted("RFS", "RS")
    root = OnFailure("on failure", child, ForceFailure("then fail", handler))
    assert play(root, [child, handler], 4) == ["R R .", "R F R", "F . S", "S S ."]


@pytest.mark.parametrize(
    ("value", "expected"),
    [(0, "F"), (1.5, "S"), ("", "F"), ("x", "S"), ((), "F"), (None, "F"), (Status, "S")],
)
def test_an_entry_holds_unless_it_is_nothing_zero_or_empty(value, expected) -> None:
    blackboard = Blackboard()
    plain, negated = EntryCondition("a", blackboard, "key"), EntryCondition("b", blackboard, "key", True)
    play(plain, [], 1)
    assert plain.status is Status.FAILURE
    blackboard.write("key", value)
    assert play(plain, [], 1) == [expected]
    assert play(negated, [], 1) == ["S" if expected == "F" else "F"]


def test_halting_the_root_interrupts_running_leaves_only() -> None:
    children = scripted("S", "R", "S")
    root = Sequence("node", children)
    root.tick_once()
    root.stop(Status.INVALID)
    assert [child.log for child in children] == [["S"], ["-"], []]
    assert all(child.status is Status.INVALID for child in children)


def test_a_leaf_that_has_ended_is_never_told_that_it_was_interrupted() -> None:
    failed, recovery = scripted("F", "R")
    root = Fallback("node", [failed, recovery])
    play(root, [], 3)
    assert failed.log == ["F"]


@pytest.mark.parametrize("kind", [ReactiveSequence, ReactiveFallback])
def test_a_reactive_node_halts_what_an_earlier_child_takes_over_from(kind) -> None:
    first = Scripted("SR" if kind is ReactiveSequence else "FR")
    second = Scripted("R")
    play(kind("node", [first, second]), [], 2)
    assert second.log == ["-"]
    assert second.status is Status.INVALID


def test_a_parallel_halts_the_rest_at_its_threshold() -> None:
    children = scripted("R", "S")
    play(Parallel("node", children, success=1), children, 1)
    assert children[0].log == ["-"]


def test_halting_reaches_through_decorators() -> None:
    child = Scripted("R")
    root = Invert("a", Retry("b", Repeat("c", child, None), 3))
    root.tick_once()
    root.stop(Status.INVALID)
    assert child.log == ["-"]


def test_a_tick_yields_children_before_parents() -> None:
    children = scripted("S", "F", "S")
    root = Sequence("node", children)
    assert list(root.tick()) == [children[0], children[1], root]


def test_the_tip_is_the_deepest_node_that_was_reached() -> None:
    children = scripted("S", "R")
    root = Subtree("tree", Sequence("node", children))
    root.tick_once()
    assert root.tip() is children[1]


def test_rounds_say_how_far_they_are() -> None:
    repeat, retry = Repeat("n", Scripted("SR"), 3), Retry("n", Scripted("FR"), 2)
    play(repeat, [], 1)
    play(retry, [], 1)
    assert repeat.feedback_message == "1 of 3 rounds done"
    assert retry.feedback_message == "1 of 3 attempts failed"


LEAVES = st.text("SFR", min_size=1, max_size=4).map(lambda script: ("leaf", script))
TREES = st.recursive(
    LEAVES,
    lambda below: st.one_of(
        st.tuples(
            st.sampled_from(["sequence", "fallback", "reactive_sequence", "reactive_fallback", "parallel"]),
            st.lists(below, min_size=1, max_size=3),
        ),
        st.tuples(st.sampled_from(["invert", "retry", "repeat", "forever"]), below),
    ),
    max_leaves=8,
)


def grow(plan, leaves: list[Scripted]) -> Behaviour:
    kind, below = plan
    if kind == "leaf":
        leaves.append(Scripted(below))
        return leaves[-1]
    if isinstance(below, list):
        lists = {"sequence": Sequence, "fallback": Fallback, "parallel": Parallel}
        lists |= {"reactive_sequence": ReactiveSequence, "reactive_fallback": ReactiveFallback}
        return lists[kind](kind, [grow(each, leaves) for each in below])
    child = grow(below, leaves)
    if kind == "invert":
        return Invert(kind, child)
    return Retry(kind, child, 2) if kind == "retry" else Repeat(kind, child, 2 if kind == "repeat" else None)


@settings(deadline=None, max_examples=200)
@given(plan=TREES, ticks=st.integers(1, 6))
def test_in_any_tree_each_round_of_a_leaf_begins_once_and_ends_once(plan, ticks) -> None:
    leaves: list[Scripted] = []
    root = grow(plan, leaves)
    for _ in range(ticks):
        root.tick_once()
        running = [leaf for leaf in leaves if leaf.status is Status.RUNNING]
        assert root.status is Status.RUNNING or not running
        for leaf in leaves:
            assert leaf.begun == len(leaf.log) + (leaf in running)
    root.stop(Status.INVALID)
    assert all(node.status is Status.INVALID for node in root.iterate())


@pytest.mark.parametrize(("duration_s", "rows"), [(1.0, "RRF"), (5.0, "RRR"), (0.2, "RFF")])
def test_a_timeout_that_is_changed_while_its_child_runs_counts_from_the_same_begin(
    duration_s: float, rows: str
) -> None:
    clock = ManualClock()
    child = Scripted("R")
    root = Timeout("node", child, 2.0, clock.now_s)
    found = play(root, [child], 1)[0][0]
    root.duration_s = duration_s
    for time_s in (0.5, 1.5):
        clock.wait_until(time_s)
        found += play(root, [child], 1)[0][0] if root.status is Status.RUNNING else "F"
    assert found == rows


def test_retries_and_rounds_may_be_changed_between_ticks() -> None:
    child = Scripted("RF")
    retry = Retry("node", child, 1)
    play(retry, [child], 1)
    retry.retries = 3
    assert [row[0] for row in play(retry, [child], 4)] == ["R", "R", "R", "F"]
    child = Scripted("RS")
    repeat = Repeat("node", child, 2)
    play(repeat, [child], 1)
    repeat.times = 3
    assert [row[0] for row in play(repeat, [child], 3)] == ["R", "R", "S"]
