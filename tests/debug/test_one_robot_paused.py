"""One robot of several stands, and the others go on."""

from __future__ import annotations

import pytest

from explore_bt.debug import (
    AddBreakpoint,
    Breakpoint,
    DebugSession,
    Evaluate,
    Look,
    Pause,
    Resume,
    Step,
    StepKind,
)
from explore_bt.errors import DebugError
from explore_bt.mission import only_robot
from explore_bt.types import Doing, Outcome
from tests.debug.conftest import Debugged
from tests.missions.conftest import Watcher

ROBOT = (
    "driver: {use: sim2d, world: box.yaml, radius: 0.2 m}, slam: ground_truth, "
    "planner: grid_astar, controller: pursuit"
)
HEAD = f"""
format: explore-bt/1
name: two
robots:
  ada: {{{ROBOT}, start: [0.6 m, 0.6 m, 0 deg]}}
  bob: {{{ROBOT}, start: [0.6 m, 2.2 m, 0 deg]}}
limits: {{time: 30 s}}
tree: main
"""
TREE = """
trees:
  main:
    sequence:
      - wait: {duration: 0.5 s}
      - turn: {by: 90 deg}
"""


@pytest.fixture
def run(debug):
    """Two robots, before their first tick."""
    return debug(tree=TREE, head=HEAD)


def ticked(run, robot: str) -> str:
    return run.do(Look(robot)).nodes[0].status


def until_bob_turns(run):
    run.do(AddBreakpoint(Breakpoint("turn", robot="bob", once=True)))
    return run.go(Resume())


def test_the_others_go_on_and_it_stands_and_its_time_with_it(run):
    run.do(Pause("ada"))
    state = until_bob_turns(run)
    assert (state.held, state.robot) == (("ada",), "bob")
    assert state.stamp_s > 0.5
    assert (ticked(run, "ada"), ticked(run, "bob")) == ("idle", "running")
    ada = run.history.at(10**9).robots[0]
    assert (ada.doing, str(ada.held_by)) == (Doing.PAUSED, "the debugger")
    run.do(Resume("ada"))
    result = run.finish()
    assert result.outcome is Outcome.EXPLORED
    assert result.mission_time_s > 0.5 + state.stamp_s, "it waited its whole time, from then on"


def test_the_run_does_not_end_before_it_has_gone_on(run):
    run.do(Pause("ada"))
    run.do(AddBreakpoint(Breakpoint("turn", status="success", robot="bob", once=True)))
    over_s = run.go(Resume()).stamp_s
    state = run.go(Step(count=20))
    assert not state.over
    assert state.stamp_s > over_s + 1.9
    run.do(Resume("ada"))
    assert run.finish().outcome is Outcome.EXPLORED


def test_it_is_stepped_by_itself_while_the_others_go_on(debug):
    watcher = Watcher()
    run = debug(tree=TREE.replace("0.5 s", "10 s"), head=HEAD, sinks=[watcher])
    run.do(Pause("ada"))
    run.do(Resume())
    run.do(Step(count=3, robot="ada"))
    state = until_bob_turns(run)
    ticks = [sum(tick.robots[number].nodes[0].ticks for tick in watcher.ticks) for number in (0, 1)]
    assert ticks[0] == 3
    assert ticks[1] > 90
    assert state.held == ("ada",)


def test_by_itself_it_is_not_stopped_in_the_middle_of_a_tick(debug):
    run = debug(tree=TREE.replace("0.5 s", "10 s"), head=HEAD)
    run.do(Pause("ada"))
    run.do(Resume())
    with pytest.raises(DebugError, match="in the middle of a tick all robots stand"):
        run.do(Step(StepKind.NODE, robot="ada"))


def test_while_all_stand_one_is_stepped_and_the_others_stand_on(run):
    run.go(Step(count=2, robot="bob"))
    assert (ticked(run, "ada"), ticked(run, "bob")) == ("idle", "running")
    run.go(Step())
    assert ticked(run, "ada") == "running"


def test_a_pause_of_the_only_robot_is_a_pause_of_the_run(debug):
    run = debug(paused=False)
    run.do(Pause("robot"))
    assert run.rest().paused


@pytest.mark.parametrize(
    ("command", "words"),
    [
        (Pause("adda"), 'there is no robot "adda".*did you mean "ada"'),
        (Resume("bob"), "robot bob is not paused alone"),
        (Step(StepKind.TICK, 0, "ada"), "a step goes 1 to"),
    ],
)
def test_what_cannot_be_done_is_said(run, command, words):
    before = run.do(Evaluate("tick"))
    with pytest.raises(DebugError, match=words):
        run.do(command)
    assert run.do(Evaluate("tick")) == before


def test_a_robot_of_a_process_of_its_own_is_held_while_its_fleet_goes_on_elsewhere(load, registry, tmp_path):
    """Its time cannot stand still: what it tells its team would grow old."""
    pytest.importorskip("zenoh", reason="eclipse-zenoh is not installed")
    team = "team: {use: zenoh, multicast: false}\ntree: main"
    mission = only_robot(load(tree=TREE, head=HEAD.replace("tree: main", team)), "ada", 100.0)
    run = Debugged(mission, registry, tmp_path / "run", DebugSession(paused=True), [])
    before = run.rest()
    assert before.paused
    assert not before.is_simulated
    while (now := run.session.state()).stamp_s < before.stamp_s + 1.0:
        assert now.paused
    assert ticked(run, "ada") == "idle"
    run.do(Resume())
    assert run.finish().outcome is Outcome.EXPLORED
