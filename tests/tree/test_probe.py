from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st
from py_trees.behaviour import Behaviour
from py_trees.common import Status

from explore_bt.tree import Fallback, Parallel, Probe, Retry, Sequence, attach, detach, tick

S, F, R = Status.SUCCESS, Status.FAILURE, Status.RUNNING


class Leaf(Behaviour):
    def __init__(self, name: str, answers: tuple[Status, ...]) -> None:
        super().__init__(name=name)
        self.answers = answers
        self.ticks = 0
        self.ended: list[Status] = []

    def update(self) -> Status:
        self.ticks += 1
        return self.answers[(self.ticks - 1) % len(self.answers)]

    def terminate(self, new_status: Status) -> None:
        self.ended.append(new_status)


class Diary(Probe):
    """Notes whom it was asked about; answers where it was told to."""

    def __init__(
        self, before: dict[str, Status] | None = None, after: dict[str, Status] | None = None
    ) -> None:
        self.lines: list[str] = []
        self._before, self._after = before or {}, after or {}

    def before(self, node: Behaviour) -> Status | None:
        self.lines.append(f"> {node.name}")
        return self._before.get(node.name)

    def after(self, node: Behaviour) -> Status | None:
        self.lines.append(f"< {node.name} {node.status.name}")
        return self._after.get(node.name)


def run(root: Behaviour, probe: Probe | None) -> Status:
    for _ in tick(root, probe):
        pass
    return root.status


def tree(*answers: tuple[Status, ...]) -> Behaviour:
    leaves = [Leaf(f"leaf{index}", script) for index, script in enumerate(answers)]
    middle = len(leaves) // 2
    return Fallback(
        "any", [Sequence("all", leaves[:middle]), Retry("again", Parallel("both", leaves[middle:]), 1)]
    )


def test_a_probe_is_asked_before_and_after_each_node_in_the_order_of_their_ticks() -> None:
    root = Sequence("all", [Leaf("first", (S,)), Leaf("second", (R,)), Leaf("third", (S,))])
    diary = Diary()
    attach(root, diary)
    assert run(root, diary) is R
    assert diary.lines == [
        "> all",
        "> first",
        "< first SUCCESS",
        "> second",
        "< second RUNNING",
        "< all RUNNING",
    ]


scripts = st.lists(
    st.lists(st.sampled_from([S, F, R]), min_size=1, max_size=4).map(tuple), min_size=4, max_size=6
)


@given(scripts, st.integers(1, 6))
def test_a_probe_that_only_looks_changes_nothing(answers, ticks) -> None:
    watched, plain = tree(*answers), tree(*answers)
    attach(watched, Diary())
    for _ in range(ticks):
        assert run(watched, Diary()) is run(plain, None)
        assert [node.status for node in watched.iterate()] == [node.status for node in plain.iterate()]


def test_an_answer_before_the_tick_takes_its_place_and_cuts_a_running_node_off() -> None:
    worker, handler = Leaf("worker", (R,)), Leaf("handler", (S,))
    root = Fallback("any", [worker, handler])
    run(root, None)
    attach(root, Diary(before={"worker": F}))
    assert run(root, None) is S
    assert (worker.ticks, worker.ended, worker.status) == (1, [Status.INVALID], F)
    assert handler.ticks == 1


def test_an_answer_after_the_tick_is_what_the_parent_sees() -> None:
    worker = Leaf("worker", (R,))
    root = Sequence("all", [worker, Leaf("next", (S,))])
    attach(root, Diary(after={"worker": S}))
    assert run(root, None) is S
    assert worker.ended == [Status.INVALID]


def test_the_root_can_be_answered_for_too() -> None:
    root = Sequence("all", [Leaf("worker", (S,))])
    assert run(root, Diary(before={"all": F})) is F
    assert run(root, Diary(after={"all": F})) is F


def test_running_cannot_be_answered_because_nothing_would_run() -> None:
    root = Sequence("all", [Leaf("worker", (S,))])
    attach(root, Diary(before={"worker": R}))
    with pytest.raises(ValueError, match="SUCCESS or FAILURE"):
        run(root, None)


def test_nobody_is_asked_once_detached() -> None:
    root, diary = tree((S,), (S,), (S,), (S,)), Diary()
    attach(root, diary)
    detach(root)
    run(root, None)
    assert diary.lines == []
