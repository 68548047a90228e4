"""Whatever clients do, they harm nobody but themselves."""

from __future__ import annotations

import threading
from concurrent.futures import Future
from concurrent.futures import wait as wait_for

import pytest

from explore_bt.debug import AddBreakpoint, Breakpoint, Command, Evaluate, Force, Look, Pause, Resume, Step
from explore_bt.debug.queue import MOST_WAITING
from explore_bt.errors import DebugError
from explore_bt.types import Outcome


class Unheard(Command[None]):
    """Nobody knows what it means."""


NONSENSE = (
    None,
    "step",
    7,
    b"\x00",
    {"command": "step"},
    Step,
    Unheard(),
    AddBreakpoint(None),
    AddBreakpoint(Breakpoint(None)),
    Force(None, None),
    Evaluate(None),
    Evaluate("x", robot="nobody"),
    Look(3),
    Step(None, None, None),
)


def test_nonsense_is_refused_and_the_run_is_as_it_would_have_been(debug, alone):
    expected = alone()
    run = debug()
    for garbage in NONSENSE:
        with pytest.raises(DebugError):
            run.do(garbage)
    assert run.session.state().breakpoints == run.session.state().forced == ()
    assert run.finish().outcome is Outcome.EXPLORED
    assert run.recording == expected


def test_a_flood_is_answered_or_refused_and_the_run_is_as_it_would_have_been(debug, alone):
    expected = alone()
    run = debug()
    run.do(Resume())
    futures: list[Future[object]] = [
        run.session.submit(Evaluate("x") if number % 2 else Look()) for number in range(100_000)
    ]
    assert run.finish().outcome is Outcome.EXPLORED
    wait_for(futures, timeout=60)
    refused = [future for future in futures if future.exception() is not None]
    assert len(futures) - len(refused) >= min(MOST_WAITING, len(futures)) // 2
    assert all(isinstance(future.exception(), DebugError) for future in refused)
    assert run.recording == expected


def test_listeners_that_raise_or_never_return_are_left_behind(debug, alone):
    expected = alone()
    heard = []
    never = threading.Event()
    run = debug()
    run.session.subscribe(lambda _: 1 / 0)
    run.session.subscribe(lambda _: never.wait())
    unsubscribe = run.session.subscribe(heard.append)
    for _ in range(3):
        run.go(Step())
    unsubscribe()
    run.finish()
    never.set()
    assert run.recording == expected
    assert any(state.paused for state in heard)


def test_a_listener_that_is_slow_gets_the_newest_state_and_none_in_between(debug):
    run = debug()
    heard, may_go_on, began = [], threading.Event(), threading.Event()

    def listen(state):
        heard.append(state)
        began.set()
        may_go_on.wait(60)

    unsubscribe = run.session.subscribe(listen)
    assert began.wait(60)
    for _ in range(20):
        state = run.go(Step())
    may_go_on.set()
    run.finish()
    unsubscribe()
    assert len(heard) < 10
    assert heard[1].tick >= state.tick


def test_who_waits_for_an_answer_may_block_for_ever_in_his_own_callback(debug):
    run = debug()
    never = threading.Event()
    run.session.submit(Look()).add_done_callback(lambda _: never.wait())
    run.session.submit(Resume())
    result = run.result.result(120)
    never.set()
    assert result.outcome is Outcome.EXPLORED


def test_an_answer_that_nobody_wants_any_more_is_thrown_away(debug):
    run = debug()
    futures = [run.session.submit(Look()) for _ in range(50)]
    for future in futures:
        future.cancel()
    assert run.do(Evaluate("1 + 1")) == 2


def test_many_threads_may_command_at_once(debug):
    run = debug()
    answers: list[object] = []

    def ask() -> None:
        for number in range(50):
            answers.append(run.do(Evaluate(f"{number} + 1")))  # noqa: PERF401  # one by one is the point

    threads = [threading.Thread(target=ask) for _ in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(60)
    assert sorted(answers) == sorted([*range(1, 51)] * 8)


def test_pausing_and_going_on_from_many_threads_never_hangs_the_run(debug):
    run = debug()

    def toggle() -> None:
        for _ in range(30):
            run.session.submit(Pause())
            run.session.submit(Resume())

    threads = [threading.Thread(target=toggle) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(60)
    while not run.result.done():
        run.session.submit(Resume())
    assert run.result.result().outcome is Outcome.EXPLORED
