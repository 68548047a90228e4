"""A robot in real time: it is held while the trees wait, and then goes on as if nothing had been."""

from __future__ import annotations

from itertools import pairwise

import pytest

from explore_bt.debug import (
    AddBreakpoint,
    Breakpoint,
    Evaluate,
    Look,
    Quit,
    RemoveBreakpoint,
    Resume,
    Step,
    StepKind,
)
from explore_bt.plugin import Registry
from explore_bt.recording import read_recording
from explore_bt.types import Outcome
from tests.debug.conftest import HEAD
from tests.debug.wall_robot import WallSim2d

WALL = HEAD.replace("use: sim2d", "use: wall_sim2d")

DRIVE = """
trees:
  main:
    sequence:
      - choose_place: {x: 3.5 m, y: 1.5 m}
      - drive_to
"""

WAIT = """
trees:
  main:
    sequence:
      - wait: {duration: 2 s}
        timeout: 3 s
"""


@pytest.fixture(scope="session")
def registry(registry: Registry) -> Registry:
    if "wall_sim2d" not in registry.names("driver"):
        registry.add(WallSim2d, "tests")
    return registry


def place(run) -> tuple[float, float]:
    return (run.do(Evaluate("x")), run.do(Evaluate("y")))


def wait_for_rest(run) -> tuple[float, float]:
    """Where the robot has come to rest: the body follows its commands with a delay."""
    while run.do(Evaluate("speed")) > 1e-3:
        pass
    here, before = place(run), None
    while before != here:
        until(run, 0.5)
        here, before = place(run), here
    return here


def until(run, seconds: float) -> None:
    """Until so much mission time has passed since now."""
    end_s = run.session.state().stamp_s + seconds
    while run.session.state().stamp_s < end_s:
        run.do(Look())


def test_a_driving_robot_is_held_while_the_trees_wait_and_then_drives_on_along_its_path(debug):
    run = debug(head=WALL, tree=DRIVE)
    run.do(AddBreakpoint(Breakpoint("drive_to", condition="speed > 0.2", once=True)))
    state = run.go(Resume())
    assert (state.is_simulated, state.path) == (False, "main/drive_to")
    here = wait_for_rest(run)
    path = run.history.at(10**6).robots[0].path
    ticks = run.session.state().tick
    until(run, 2.0)
    assert place(run) == pytest.approx(here, abs=1e-3)
    assert "held by the debugger: breakpoint 1" in run.do(Evaluate("gate"))
    held = run.history.at(10**6).robots[0]
    assert run.session.state().tick > ticks  # sensors, SLAM and observers go on
    assert str(held.held_by) == "the debugger"
    assert held.path is path
    assert held.nodes[-1].status == "running"

    run.do(AddBreakpoint(Breakpoint("drive_to", condition="speed > 0.2", once=True)))
    run.go(Resume())
    assert run.history.at(10**6).robots[0].path is path  # not planned anew
    result = run.finish()
    assert (result.outcome, result.contacts) == (Outcome.EXPLORED, 0)
    assert "drive_to: arrived" in result.reason


def test_what_counts_the_trees_time_stands_still_while_they_wait(debug):
    run = debug("budget=6 s", head=WALL, tree=WAIT)
    run.go(Step(StepKind.NODE, 3))
    until(run, 7.0)
    result = run.finish()
    assert result.outcome is Outcome.EXPLORED, result.reason
    assert result.mission_time_s > 9.0


def test_the_record_tells_of_the_hold_and_goes_on_meanwhile(debug):
    run = debug(head=WALL, tree=WAIT)
    run.go(Step())
    until(run, 1.0)
    run.finish()
    recording = read_recording(run.out / "recording.mcap")
    events = [event.value["message"] for event in recording.messages("/events")]
    assert "the robots are held: stepped 1 tick" in events
    assert any(event.startswith("the robots go on after ") for event in events)
    gates = [message.value["reason"] for message in recording.messages("/robot/gate")]
    assert "held by the debugger: stepped 1 tick" in gates
    stamps = [message.stamp_s for message in recording.messages()]
    assert max(b - a for a, b in pairwise(stamps)) < 1.5


def test_a_held_robot_is_let_go_when_it_is_to_stop(debug):
    run = debug(head=WALL, tree=DRIVE)
    run.do(AddBreakpoint(Breakpoint("drive_to", condition="speed > 0.2")))
    run.go(Resume())
    run.do(Quit())
    assert run.result.result(60).outcome is Outcome.STOPPED


def test_a_hold_may_begin_and_end_many_times_on_one_drive(debug):
    run = debug(head=WALL, tree=DRIVE)
    run.do(AddBreakpoint(Breakpoint("drive_to", condition="speed > 0.2")))
    for holds in range(4):
        if run.go(Resume()).over:  # a machine that is late lets it drive farther
            assert holds >= 2
            break
        wait_for_rest(run)
    else:
        run.do(RemoveBreakpoint(0))
    result = run.finish()
    assert (result.outcome, result.contacts) == (Outcome.EXPLORED, 0)
