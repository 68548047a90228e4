from __future__ import annotations

from itertools import cycle

from py_trees.behaviour import Behaviour

from explore_bt.interfaces import NodeInfo
from explore_bt.mission import BuiltTree
from explore_bt.runtime.tree_news import TreeNews
from explore_bt.testing.fake_robot import FakeRobot, open_floor
from explore_bt.tree import (
    Blackboard,
    EntryCondition,
    Fallback,
    Leaf,
    OnFailure,
    ReactiveFallback,
    Retry,
    Sequence,
    Status,
    Timeout,
    tick,
)
from explore_bt.tree.control import ForceFailure

S, F, R = Status.SUCCESS, Status.FAILURE, Status.RUNNING


class Speaker(Leaf):
    type_key = "speaker"

    def __init__(self, name: str, *script: tuple[Status, str]) -> None:
        super().__init__(name, FakeRobot(open_floor(2.0)), Blackboard())
        self._script = cycle(script)

    def update(self) -> Status:
        status, words = next(self._script)
        self.say(words)
        return status


def told(root: Behaviour, ticks: int = 1, level: str = "info") -> list[str]:
    """What is told in so many ticks of 0.1 s, ``source: message``."""
    nodes = tuple(root.iterate(direct_descendants=False))
    infos = tuple(NodeInfo(k, node.name, node.name, "", None, "") for k, node in enumerate(nodes))
    news = TreeNews(BuiltTree(root, nodes, infos))
    return [
        f"{each.source}: {each.message}"
        for k in range(ticks)
        for node in tick(root)
        for each in news.of(node, 0.1 * k)
        if each.level == level
    ]


def test_what_takes_over_is_told_with_the_reason_of_the_failure() -> None:
    drive = Sequence("drive", [Speaker("choose", (S, "a")), Speaker("go", (F, "held 0.2 m from a wall"))])
    root = Fallback("any", [drive, Speaker("back_out", (R, "1.0 m back")), Speaker("third", (S, ""))])
    assert told(root, ticks=20) == ["recovery: back_out, for go: held 0.2 m from a wall"]


def test_a_question_answered_no_is_no_failure() -> None:
    silent, entry = Speaker("is it late", (F, "")), EntryCondition("$late", {}, "late")
    assert told(Fallback("any", [silent, entry, Speaker("go", (S, "gone"))])) == []


def test_the_last_failure_that_nobody_mends_is_no_recovery() -> None:
    assert told(Fallback("any", [Speaker("a", (F, "no"))])) == []


def test_another_attempt_is_told_with_those_that_are_left() -> None:
    root = Retry("again", Speaker("go", (F, "first"), (F, "second"), (F, "third")), 2)
    assert told(root) == [
        "recovery: go once more, 2 left, for go: first",
        "recovery: go once more, 1 left, for go: second",
    ]


def test_a_timeout_fails_in_its_own_words() -> None:
    clock = iter([0.0, 0.0, 5.0])
    limited = Timeout("timeout 3 s", Speaker("go", (R, "going")), 3.0, lambda: next(clock))
    handler = ForceFailure("then fail", Speaker("stop", (S, "")))
    assert told(OnFailure("on failure", limited, handler), ticks=2) == [
        "recovery: then fail, for timeout 3 s: gave up after 3 s"
    ]


def test_a_reactive_fallback_that_fails_over_every_tick_tells_it_once() -> None:
    root = ReactiveFallback("any", [Speaker("see", (F, "nobody near")), Speaker("go", (R, ""))])
    assert told(root, ticks=30) == ["recovery: go, for see: nobody near"]
    at_once = ReactiveFallback("any", [Speaker("see", (F, "nobody near")), Speaker("go", (S, ""))])
    assert told(at_once, ticks=30) == ["recovery: go, for see: nobody near"]


def test_leaves_are_told_when_they_end_and_when_they_say_something_new_but_not_when_they_count() -> None:
    script = [(R, "to (1, 2)"), (R, "2.0 m to go"), (R, "1.5 m to go"), (F, "held"), (R, "2.0 m to go")]
    assert told(Speaker("go", *script), ticks=5, level="debug") == [
        "go: to (1, 2)",
        "go: 2.0 m to go",
        "go: failed: held",
        "go: 2.0 m to go",
    ]


def test_the_same_words_after_a_while_are_told_again() -> None:
    script = [(S, "took 41°"), *([(R, "")] * 20)]
    assert told(Speaker("find", *script), ticks=22, level="debug") == ["find: took 41°"] * 2
