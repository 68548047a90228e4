"""Our nodes against the real BehaviorTree.CPP: same tree, same answers, same ticks and halts."""

from __future__ import annotations

import threading
from pathlib import Path

import pytest

from explore_bt.plugin import Registry
from tests.mission.btcpp.conformance import Grower, Log, Ours, Theirs, catalog, load

TREES = 2000
TICKS = 8
ENDLESS = 1000
"""Leaves ticked in one tick: BehaviorTree.CPP would not come back from it."""


@pytest.fixture(scope="module")
def registry() -> Registry:
    return catalog()


@pytest.mark.parametrize("part", range(4))
def test_random_trees_tick_as_in_behaviortree_cpp(part: int, registry: Registry, tmp_path: Path) -> None:
    endless = 0
    for seed in range(part * TREES // 4, (part + 1) * TREES // 4):
        grower = Grower(seed)
        text = grower.grow()
        root = load(text, tmp_path, registry)
        ours = Ours(root, grower.scripts)
        played = [ours.tick() for _ in range(TICKS)]
        if max(len(log) for _, log in played) >= ENDLESS:
            endless += 1
            continue
        theirs = Theirs(root, grower.scripts)
        assert [theirs.tick() for _ in range(TICKS)] == played, f"seed {seed}, {grower.scripts}\n{text}"
    assert endless <= 3


def test_trees_whose_time_is_up_tick_as_in_behaviortree_cpp(registry: Registry, tmp_path: Path) -> None:
    pairs = [pair for seed in range(300) if (pair := pair_with_timeout(seed, registry, tmp_path))]
    assert len(pairs) > 30
    for ours, theirs in pairs:
        assert theirs.tick() == ours.tick()
        theirs.scripts.log = []
    # their timers run on the wall's clock, in threads of their own that need the interpreter
    threading.Event().wait(3.0)
    for ours, theirs in pairs:
        early = theirs.scripts.log
        theirs.tree.sleep(0)  # an executor's pause, which the timer cut short
        ours.scripts.clock.wait_until(1.0)
        their_status, log = theirs.tick()
        our_status, our_log = ours.tick()
        assert their_status == our_status
        assert ordered(early + log) == ordered(our_log)


def ordered(log: Log) -> tuple[Log, Log]:
    """The ticks in their order, and what each leaf lived through.

    Their timers halt between the ticks, ours when it is the node's turn: halts of different leaves may come
    in another order. And a timer's thread may halt a leaf that the tick is halting: twice is once.
    """
    by_leaf = sorted(log, key=lambda event: event[0])
    once = [
        event
        for before, event in zip([None, *by_leaf], by_leaf, strict=False)
        if event[1] != "halt" or event != before
    ]
    return [event for event in log if event[1] != "halt"], once


def pair_with_timeout(seed: int, registry: Registry, folder: Path) -> tuple[Ours, Theirs] | None:
    grower = Grower(seed, timeouts=True)
    root = load(grower.grow(), folder, registry)
    rehearsal = Ours(root, grower.scripts)
    played = [rehearsal.tick(), rehearsal.tick()]
    has_timer = any(node.modifiers.timeout_s for node in root.walk())
    if not has_timer or played[0][0] != "R" or any(len(log) >= ENDLESS for _, log in played):
        return None
    return Ours(root, grower.scripts), Theirs(root, grower.scripts)
