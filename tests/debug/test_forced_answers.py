"""Forced answers: the tree takes them, the record shows them, nothing else changes."""

from __future__ import annotations

import pytest

from explore_bt.debug import AddBreakpoint, Breakpoint, Force, Look, Release, Resume, Step
from explore_bt.errors import DebugError
from explore_bt.recording import read_recording
from explore_bt.types import Outcome

TREE = """
trees:
  main:
    sequence:
      - fallback:
          - wait: {duration: 0.3 s}
            name: tried
          - wait: {duration: 0.2 s}
            name: rescue
      - repeat: {times: 3, child: {wait: {duration: 0.1 s}, name: again}}
"""

DRIVE = """
trees:
  main:
    sequence:
      - choose_place: {x: 3.5 m, y: 1.5 m}
      - fallback:
          - drive_to
          - sequence: [give_up_goal]
"""


def told(run):
    """What the debugger did, from the recording."""
    events = read_recording(run.out / "recording.mcap").messages("/events")
    return [event.value["message"] for event in events if event.value["name"].endswith("debugger")]


def messages_of(run, node):
    """What a node said in the course of the run, from the recording."""
    recording = read_recording(run.out / "recording.mcap")
    (number,) = (info["id"] for info in recording.info["trees"]["robot"] if info["name"] == node)
    return [
        (state["status"], state["message"])
        for message in recording.messages("/robot/tree")
        for state in message.value["nodes"]
        if state["id"] == number
    ]


def test_a_forced_failure_leads_to_the_rescue_and_the_record_says_who_failed(debug):
    run = debug(tree=TREE)
    assert run.do(Force("tried", "failure", once=True)) == 1
    assert [forced.path for forced in run.session.state().forced] == ["main/fallback/tried"]
    assert run.finish().outcome is Outcome.EXPLORED
    assert ("failure", "forced to FAILURE by the debugger") in messages_of(run, "tried")
    assert any(status == "success" for status, _ in messages_of(run, "rescue"))
    assert told(run) == [
        "main/fallback/tried is forced to FAILURE once",
        "main/fallback/tried: forced to FAILURE by the debugger",
    ]


def test_a_forced_node_is_not_ticked_and_a_running_one_is_cut_off(debug):
    run = debug(tree=TREE)
    run.go(Step())
    run.do(Force("tried", "success"))
    run.go(Step())
    view = run.do(Look())
    states = dict(zip((info.name for info in run.history.run.trees["robot"]), view.nodes, strict=True))
    assert (states["tried"].status, states["rescue"].status) == ("success", "idle")


def test_once_means_the_first_of_the_nodes_that_is_ticked(debug):
    run = debug(tree=TREE)
    assert run.do(Force("fallback/*", "failure", once=True)) == 2
    assert run.finish().outcome is Outcome.EXPLORED
    assert any(status == "success" for status, _ in messages_of(run, "rescue"))


def test_one_that_is_forced_anew_stays_forced_when_the_others_are_done(debug):
    run = debug(tree=TREE)
    run.do(Force("fallback/*", "failure", once=True))
    run.do(Force("rescue", "success"))
    run.do(AddBreakpoint(Breakpoint("rescue")))
    run.go(Resume())
    assert [(each.path, each.once) for each in run.session.state().forced] == [
        ("main/fallback/rescue", False)
    ]


def test_until_released_every_tick_is_answered_and_one_event_tells_of_it(debug):
    run = debug("budget=2 s", tree=TREE)
    run.do(Force("again", "success"))
    run.finish()
    assert told(run).count("main/repeat/again: forced to SUCCESS by the debugger") == 1


def test_what_is_released_is_ticked_again_and_speaks_for_itself(debug):
    run = debug(tree=TREE)
    run.do(Force("tried", "failure"))
    run.do(Force("rescue", "failure"))
    assert run.do(Release("tried")) == 1
    assert run.do(Release("tried")) == 0
    assert run.do(Release()) == 1
    assert run.session.state().forced == ()
    run.finish()
    assert all("forced" not in message for _, message in messages_of(run, "tried"))


def test_a_forced_failure_gives_the_recovery_a_code_to_read(debug):
    run = debug(tree=DRIVE)
    run.do(Force("drive_to", "failure", once=True))
    result = run.finish()
    assert result.outcome is Outcome.EXPLORED, result.reason
    assert dict(run.history.at(10**6).robots[0].blackboard)["failure"] == "forced"


@pytest.mark.parametrize(
    ("command", "refusal"),
    [
        (Force("tried", "running"), 'forced to "running"; say success or failure'),
        (Force("tired", "failure"), 'did you mean "tried"?'),
        (Release("tired"), 'did you mean "tried"?'),
    ],
)
def test_what_cannot_be_forced_is_refused(debug, command, refusal):
    run = debug(tree=TREE)
    with pytest.raises(DebugError) as refused:
        run.do(command)
    assert refusal in str(refused.value)


def test_a_run_that_goes_on_after_looking_is_as_it_would_have_been(debug, alone):
    expected = alone(tree=TREE)
    run = debug(tree=TREE)
    with pytest.raises(DebugError):
        run.do(Force("tired", "failure"))
    run.do(Look())
    run.go(Resume())
    assert run.recording == expected
