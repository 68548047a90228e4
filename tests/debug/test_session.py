"""Pausing and stepping: where the run stops, and that nobody can tell afterwards that it did."""

from __future__ import annotations

import pytest

from explore_bt.debug import (
    AddBreakpoint,
    Breakpoint,
    Evaluate,
    Look,
    Moment,
    Pause,
    Quit,
    RemoveBreakpoint,
    Resume,
    Step,
    StepKind,
)
from explore_bt.errors import DebugError
from explore_bt.types import Outcome


@pytest.mark.parametrize("kind", StepKind)
def test_a_run_stepped_to_its_end_is_recorded_byte_for_byte_as_one_let_go(debug, alone, kind):
    expected = alone()
    run = debug()
    steps = 0
    while not run.go(Step(kind)).over:
        steps += 1
    assert steps > {StepKind.TICK: 60, StepKind.NODE: 150, StepKind.CHANGE: 10}[kind]
    assert run.result.result().outcome is Outcome.EXPLORED
    assert run.recording == expected


def test_a_run_that_breakpoints_stop_is_recorded_as_one_let_go(debug, alone):
    expected = alone()
    run = debug()
    for each in (
        Breakpoint("*", status="failure"),
        Breakpoint("drive_to", Moment.BEFORE, condition="tick % 7 == 0"),
        Breakpoint("second", condition="$goal.pose.x > 1 or time > 0.9"),
    ):
        run.do(AddBreakpoint(each))
    stops = []
    while not (state := run.go(Resume())).over:
        stops.append((state.path, state.moment))
        run.do(Evaluate("speed"))
        run.do(Look())
    assert {"main/drive_to", "main/fallback/second"} <= {path for path, _ in stops}
    assert ("main/drive_to", "before") in stops
    assert run.recording == expected


def test_it_stands_still_before_the_first_tick_and_time_stands_still_with_it(debug):
    run = debug()
    state = run.session.state()
    assert (state.paused, state.why, state.path) == (True, "before the first tick", "")
    assert {node.status for node in run.do(Look()).nodes} == {"idle"}
    assert run.session.state().stamp_s == state.stamp_s


def test_a_step_of_ticks_goes_so_many_ticks(debug):
    run = debug()
    before = run.session.state()
    after = run.go(Step(StepKind.TICK, 7))
    assert after.tick == before.tick + 7
    assert after.stamp_s == pytest.approx(before.stamp_s + 0.7)
    assert after.path == ""


def test_a_step_of_a_node_ends_after_the_next_node_that_was_ticked_children_before_parents(debug):
    run = debug()
    paths = [run.go(Step(StepKind.NODE)).path for _ in range(5)]
    first = "main/first"
    assert paths == [first, f"{first}@timeout", f"{first}@retry", "main", first]


def test_steps_in_the_middle_of_a_tick_show_the_tree_in_the_middle_of_a_tick(debug):
    run = debug()
    run.go(Step(StepKind.NODE))
    infos = run.history.run.trees["robot"]
    states = {info.path: node.status for info, node in zip(infos, run.do(Look()).nodes, strict=True)}
    assert (states["main/first"], states["main"]) == ("running", "idle")


def test_a_step_to_a_change_passes_by_what_stays_as_it_is(debug):
    run = debug()
    for _ in range(4):
        run.go(Step(StepKind.CHANGE))
    state = run.go(Step(StepKind.CHANGE))
    assert (state.path, state.status) == ("main/first", "success")
    assert "from running to success" in state.why


def test_steps_that_are_asked_for_at_once_add_up(debug):
    run = debug()
    before = run.session.state().tick
    futures = [run.session.submit(Step()) for _ in range(5)]
    for future in futures:
        future.result(20)
    while run.rest().tick < before + 5:
        pass
    assert run.rest().tick == before + 5


def test_a_run_can_be_paused_while_it_goes_on(debug):
    run = debug("first=40 s", "budget=60 s")
    run.do(Resume())
    run.do(Pause())
    state = run.rest()
    assert (state.paused, state.why) == (True, "paused by hand")
    assert run.go(Step()).tick == state.tick + 1


def test_a_run_that_is_paused_stops_when_the_flag_is_raised(debug):
    run = debug()
    run.go(Step(StepKind.NODE, 3))
    run.stop.raise_flag("enough")
    result = run.result.result(60)
    assert (result.outcome, result.reason) == (Outcome.STOPPED, "enough")


def test_quit_ends_a_paused_run_and_its_results_are_saved(debug):
    run = debug()
    run.do(Quit())
    assert run.result.result(60).outcome is Outcome.STOPPED
    assert (run.out / "result.json").is_file()


def test_breakpoints_no_longer_stop_a_run_that_is_to_stop(debug):
    run = debug()
    run.do(AddBreakpoint(Breakpoint("*", Moment.BEFORE)))
    run.stop.raise_flag("enough")
    assert run.result.result(60).outcome is Outcome.STOPPED


def test_a_run_that_is_over_says_so_to_whoever_asks_for_more(debug):
    run = debug()
    run.finish()
    state = run.rest()
    assert (state.over, state.paused) == (True, False)
    assert state.why.startswith("explored: ")
    with pytest.raises(DebugError, match="the run is over"):
        run.do(Step())


def test_a_session_whose_run_never_begins_is_over_too(debug):
    run = debug("radius=1.5 m", paused=False)
    with pytest.raises(Exception, match=r"start|fit|free|wall"):
        run.result.result(60)
    assert run.rest().over


@pytest.mark.parametrize(
    ("step", "refusal"),
    [
        (Step(StepKind.TICK, 0), "1 to 1,000,000 times"),
        (Step(StepKind.TICK, -3), "1 to 1,000,000 times"),
        (Step("tock"), 'no step "tock"'),
        (Step(robot="robbie"), 'no robot "robbie"; robots: robot'),
    ],
)
def test_a_step_that_makes_no_sense_is_refused_and_nothing_moves(debug, step, refusal):
    run = debug()
    before = run.session.state()
    with pytest.raises(DebugError, match=refusal):
        run.do(step)
    assert run.session.state() == before


def test_removing_what_is_not_there_is_refused(debug):
    with pytest.raises(DebugError, match="no breakpoint 3; known: none is set"):
        debug().do(RemoveBreakpoint(3))
