"""Parameters changed in a paused run: checked as ``--set`` does, applied where they are used, or refused."""

from __future__ import annotations

import pytest

from explore_bt.debug import AddBreakpoint, Breakpoint, Resume, SetParam, Step
from explore_bt.errors import DebugError
from explore_bt.recording import read_recording
from explore_bt.types import Outcome


def value_of(run, name):
    return next(param.value for param in run.session.state().params if param.name == name)


def test_a_leaf_goes_by_the_new_value_and_the_record_says_so(debug):
    run = debug()
    words = run.do(SetParam("first", "1.2 s"))
    assert words == "first = 1.2 s, was 0.5 s: duration of main/first"
    run.do(AddBreakpoint(Breakpoint("first", status="success")))
    begun_s = run.go(Step()).stamp_s - 0.1
    assert run.go(Resume()).stamp_s == pytest.approx(begun_s + 1.2)
    assert value_of(run, "first") == "1.2 s"
    run.finish()
    events = read_recording(run.out / "recording.mcap").messages("/events")
    assert words in [event.value["message"] for event in events]


def test_a_timeout_that_is_under_way_gets_the_new_duration(debug):
    run = debug("first=2 s", "limit=1 s", "again=1")
    run.go(Step())
    run.do(SetParam("limit", "5 s"))
    assert run.finish().outcome is Outcome.EXPLORED


def test_a_retry_gets_the_new_number(debug):
    run = debug("first=2 s", "limit=0.2 s")
    assert run.do(SetParam("again", "3")) == "again = 3, was 1: retry of main/first"
    run.do(AddBreakpoint(Breakpoint("first@timeout", status="failure")))
    count = 0
    while not run.go(Resume()).over:
        count += 1
    assert count == 4


def test_values_set_one_after_the_other_all_hold(debug):
    run = debug("first=0.3 s")
    run.do(SetParam("first", "0.7 s"))
    run.do(SetParam("limit", "9 s"))
    run.do(SetParam("first", "0.9 s"))
    assert (value_of(run, "first"), value_of(run, "limit")) == ("0.9 s", "9 s")


def test_a_parameter_that_no_tree_uses_changes_nothing_and_says_so(debug):
    words = debug().do(SetParam("unused", "2"))
    assert words == "unused = 2, was 1: nothing in the trees of this run uses it"


@pytest.mark.parametrize(
    ("name", "text", "refusal"),
    [
        ("first", "90 s", "is not a duration between 0.1 s and 60 s"),
        ("first", "3 m", "is not a duration"),
        ("first", "{a", "not YAML"),
        ("frist", "3 s", 'no parameter "frist"; did you mean "first"?'),
        ("limits.time", "3 s", 'no parameter "limits.time"'),
        (
            "radius",
            "0.3 m",
            "radius decides on option radius of driver sim2d: that is made",
        ),
        ("budget", "9 s", "budget decides on limits.time: "),
    ],
)
def test_what_set_would_not_take_or_what_cannot_change_is_refused_as_a_whole(debug, name, text, refusal):
    run = debug()
    before = run.session.state().params
    with pytest.raises(DebugError) as refused:
        run.do(SetParam(name, text))
    assert refusal in str(refused.value)
    assert run.session.state().params == before


def test_a_mission_that_was_edited_meanwhile_is_not_mixed_with_the_one_that_runs(debug, folder):
    run = debug()
    mission = folder / "mission.yaml"
    mission.write_text(mission.read_text().replace("0.3 s", "0.4 s"))
    with pytest.raises(DebugError, match="files have changed since the run began"):
        run.do(SetParam("first", "0.9 s"))


def test_a_run_that_goes_on_has_to_be_paused_first(debug):
    run = debug("first=40 s", "budget=60 s")
    run.do(Resume())
    with pytest.raises(DebugError, match="pause first"):
        run.do(SetParam("first", "1 s"))
