"""From typed lines to commands."""

from __future__ import annotations

import contextlib

import pytest
from hypothesis import given
from hypothesis import strategies as st

from explore_bt.debug import Breakpoint, Force, Moment, Step, StepKind
from explore_bt.debug.terminal.parsing import Span, breakpoint_of, force_of, span_of, step_of
from explore_bt.debug.terminal.verbs import VERBS, find_verb, help_lines
from explore_bt.errors import DebugError


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("", Step()),
        ("5", Step(count=5)),
        ("node", Step(StepKind.NODE)),
        ("3 nodes", Step(StepKind.NODE, 3)),
        ("change 2", Step(StepKind.CHANGE, 2)),
        ("TICK", Step(StepKind.TICK)),
    ],
)
def test_a_step_is_a_number_and_a_kind_in_any_order(text, expected):
    assert step_of(text) == expected


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("drive_to", Breakpoint("drive_to")),
        ("drive_to before", Breakpoint("drive_to", Moment.BEFORE)),
        ("drive_to FAILURE", Breakpoint("drive_to", status="failure")),
        ("drive_to idle", Breakpoint("drive_to", Moment.BEFORE, "idle")),
        ('"as long as*/drive_to" once ignore 3', Breakpoint("as long as*/drive_to", ignore=3, once=True)),
        ("'if' if time > 3", Breakpoint("if", condition="time > 3")),
        (
            "x robot bob after success if 'a if b' in message and $n == 1",
            Breakpoint("x", status="success", robot="bob", condition="'a if b' in message and $n == 1"),
        ),
    ],
)
def test_a_breakpoint_is_a_path_and_what_one_likes_to_add(text, expected):
    assert breakpoint_of(text) == expected


def test_a_forced_answer_is_a_path_and_an_answer():
    assert force_of("drive_to FAILURE") == Force("drive_to", "failure")
    assert force_of('"go there/*" success once robot bob') == Force("go there/*", "success", True, "bob")


@pytest.mark.parametrize(
    ("text", "expected"),
    [("", Span(1)), ("20", Span(20)), ("30 s", Span(seconds=30.0)), ("0.5s", Span(seconds=0.5))],
)
def test_a_span_is_ticks_or_seconds(text, expected):
    assert span_of(text) == expected


@pytest.mark.parametrize(
    ("parse", "text", "complaint"),
    [
        (step_of, "''", 'there is no step ""'),
        (step_of, "nodde", 'did you mean "node"?'),
        (step_of, "5x", "write a whole number"),
        (breakpoint_of, "", "break where?"),
        (breakpoint_of, "x if", "if what?"),
        (breakpoint_of, "x ignore", "ignore how many hits?"),
        (breakpoint_of, "x ignore many", '"many" is not a number of hits'),
        (breakpoint_of, "x robot", "which robot?"),
        (breakpoint_of, "x failed", 'did you mean "failure"?'),
        (force_of, "x", "force what, to what?"),
        (force_of, "x running", 'cannot be forced to "running"'),
        (force_of, "x failure twice", '"twice" is not understood here'),
        (span_of, "10 m", "back 30 s"),
    ],
)
def test_what_is_mistyped_is_told_with_what_to_type(parse, text, complaint):
    with pytest.raises(DebugError) as refusal:
        parse(text)
    assert complaint in str(refusal.value)


@given(st.text(max_size=40) | st.text("abif \"'0123 once robot", max_size=40))
def test_whatever_is_typed_is_understood_or_refused(text):
    for parse in (step_of, breakpoint_of, force_of, span_of, find_verb):
        with contextlib.suppress(DebugError):  # any other exception would be a fault
            parse(text)


def test_every_verb_is_found_by_its_name_its_letter_and_a_beginning_of_its_own():
    for verb in VERBS:
        assert find_verb(verb.name) is verb
        if verb.short:
            assert find_verb(verb.short) is verb
    assert find_verb("cont").name == "continue"
    with pytest.raises(DebugError, match='"fo" may be force or forward'):
        find_verb("fo")
    with pytest.raises(DebugError, match='"r" may be release or robot'):
        find_verb("r")


def test_no_two_verbs_share_a_name_or_a_letter():
    names = [verb.name for verb in VERBS] + [verb.short for verb in VERBS if verb.short]
    assert len(set(names)) == len(names)


def test_every_verb_has_help_of_its_own():
    for verb in VERBS:
        assert verb.does in "\n".join(help_lines(verb.name))
        assert verb.does in "\n".join(help_lines())
