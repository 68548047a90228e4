"""Breakpoints: they stop where they say, count what they hit, and refuse what cannot be."""

from __future__ import annotations

import pytest

from explore_bt.debug import (
    AddBreakpoint,
    Breakpoint,
    EnableBreakpoint,
    Evaluate,
    Look,
    Moment,
    RemoveBreakpoint,
    Resume,
)
from explore_bt.errors import DebugError

TWO = """
format: explore-bt/1
name: two
robots:
  ada:
    start: [1 m, 1 m, 0 deg]
    driver: {use: sim2d, world: box.yaml}
    slam: ground_truth
    planner: grid_astar
    controller: pursuit
    tree: short
  bob:
    start: [4 m, 2 m, 0 deg]
    driver: {use: sim2d, world: box.yaml}
    slam: ground_truth
    planner: grid_astar
    controller: pursuit
    tree: long
trees:
  short: {wait: {duration: 0.3 s}}
  long: {sequence: [wait: {duration: 0.6 s}, wait: {duration: 0.3 s}]}
"""


def stops(run):
    """(path, moment, status) of every stop until the end."""
    found = []
    while not (state := run.go(Resume())).over:
        found.append((state.path, state.moment, state.status))
    return found


def test_it_stops_after_the_status_it_waits_for(debug):
    run = debug()
    run.do(AddBreakpoint(Breakpoint("*", status="success")))
    assert stops(run) == [
        (f"main{path}", "after", "success")
        for path in (
            "/first",
            "/first@timeout",
            "/first@retry",
            "/fallback/invert/wait_until_localised",
            "/fallback/second",
            "/fallback",
            "/choose_place",
            "/drive_to",
            "",
        )
    ]


def test_it_stops_before_a_node_while_it_is_as_the_last_tick_left_it(debug):
    run = debug()
    run.do(AddBreakpoint(Breakpoint("choose_place", Moment.BEFORE, "idle")))
    run.do(AddBreakpoint(Breakpoint("second", Moment.BEFORE, "running", once=True)))
    assert stops(run) == [
        ("main/fallback/second", "before", "running"),
        ("main/choose_place", "before", "idle"),
    ]


@pytest.mark.parametrize(
    ("path", "count"),
    [
        ("drive_to", 1),
        ("main/drive_to", 1),
        ("fallback/second", 1),
        ("*", 10),
        ("first*", 3),
        ("main", 1),
        ("m*", 10),
    ],
)
def test_a_path_means_names_ends_of_paths_and_patterns(debug, path, count):
    run = debug()
    run.do(AddBreakpoint(Breakpoint(path)))
    (state,) = run.session.state().breakpoints
    assert state.nodes == count


def test_hits_are_counted_those_that_are_ignored_too(debug):
    run = debug()
    number = run.do(AddBreakpoint(Breakpoint("first", status="running", ignore=3)))
    state = run.go(Resume())
    (watched,) = state.breakpoints
    assert (watched.number, watched.hits) == (number, 4)
    assert state.tick - 1 == 3
    assert "breakpoint 1: main/first gave RUNNING (0.2 s to go)" in state.why


def test_one_that_is_disabled_neither_stops_nor_counts_until_it_is_enabled(debug):
    run = debug()
    number = run.do(AddBreakpoint(Breakpoint("*", enabled=False)))
    other = run.do(AddBreakpoint(Breakpoint("first", status="success")))
    run.go(Resume())
    assert run.session.state().breakpoints[0].hits == 0
    run.do(EnableBreakpoint(number, enabled=True))
    run.do(RemoveBreakpoint(other))
    assert run.go(Resume()).path == "main/first@timeout"


def test_one_that_is_for_once_is_gone_after_its_first_stop(debug):
    run = debug()
    run.do(AddBreakpoint(Breakpoint("first", once=True)))
    assert len(stops(run)) == 1
    assert run.session.state().breakpoints == ()


def test_of_two_at_one_place_the_first_is_named_and_both_count(debug):
    run = debug()
    for _ in range(2):
        run.do(AddBreakpoint(Breakpoint("first", once=True)))
    assert run.go(Resume()).why.startswith("breakpoint 1: ")
    assert run.session.state().breakpoints == ()


def test_a_condition_sees_the_robot_and_the_node(debug):
    run = debug()
    condition = "$goal.pose.x > 3 and x > 2 and speed > 0.1 and status == 'running' and 'to (' in message"
    run.do(AddBreakpoint(Breakpoint("drive_to", condition=condition)))
    assert run.go(Resume()).path == "main/drive_to"
    assert run.do(Evaluate("x > 2 and $goal.pose.x == 3.5 and status == 'running'")) is True
    assert "goal" in run.do(Look()).blackboard


def test_a_condition_without_a_value_does_not_hold_and_says_why(debug):
    run = debug()
    run.do(AddBreakpoint(Breakpoint("first", condition="message * 2 > 3")))
    run.do(AddBreakpoint(Breakpoint("second")))
    state = run.go(Resume())
    assert state.path == "main/fallback/second"
    assert "is not a number" in state.breakpoints[0].fault
    assert state.breakpoints[0].hits == 0


def test_of_two_robots_the_one_that_is_meant_stops_the_run(debug):
    run = debug(head=TWO, tree="")
    with pytest.raises(DebugError, match='no node is called "short"'):
        run.do(AddBreakpoint(Breakpoint("short", robot="bob")))
    with pytest.raises(DebugError, match='no robot "bib"; did you mean "bob"'):
        run.do(AddBreakpoint(Breakpoint("wait", robot="bib")))
    run.do(AddBreakpoint(Breakpoint("*", status="success", robot="bob", condition="robot == 'bob'")))
    state = run.go(Resume())
    assert (state.robot, state.path) == ("bob", "long/wait")
    assert run.do(Look()).robot == "bob"
    assert run.do(Look("ada")).nodes[0].status == "success"


@pytest.mark.parametrize(
    ("wanted", "refusal"),
    [
        (Breakpoint("drive_too"), 'no node is called "drive_too"; did you mean "drive_to"?'),
        (Breakpoint("main/frist"), 'did you mean "main/first"?'),
        (Breakpoint("first", status="failed"), 'no status "failed"; did you mean "failure"?'),
        (Breakpoint("first", status="idle"), "no node is idle after its tick"),
        (Breakpoint("first", "during"), 'no moment "during"'),
        (Breakpoint("first", ignore=-1), "a whole number of hits from 0 on, not -1"),
        (Breakpoint("first", ignore="many"), "a whole number of hits from 0 on, not 'many'"),
        (Breakpoint("first", condition="$gaol == 3"), 'nothing writes $gaol; did you mean "goal"?'),
        (Breakpoint("first", condition="1 +"), "column 4: not an expression"),
        (Breakpoint(7), "are texts"),
        (Breakpoint("*a" * 5000), "10000 characters; at most 2000"),
        (Breakpoint("[*"), "no node is called"),
    ],
)
def test_what_cannot_be_is_refused_and_nothing_is_set(debug, wanted, refusal):
    run = debug()
    with pytest.raises(DebugError) as refused:
        run.do(AddBreakpoint(wanted))
    assert refusal in str(refused.value)
    assert run.session.state().breakpoints == ()
