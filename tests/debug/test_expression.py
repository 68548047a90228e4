"""Expressions: they mean what Python means, and can do no harm."""

from __future__ import annotations

import contextlib
import enum
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from explore_bt.debug import Expression, ExpressionError
from explore_bt.debug.expression import LONGEST
from explore_bt.types import Pose2, Waypoint


class Colour(enum.StrEnum):
    RED = "red"


@dataclass(frozen=True)
class Trap:
    """A plugin's value at its worst."""

    angry: int = 1

    def __eq__(self, other: object) -> bool:
        raise RuntimeError("not to be compared")

    __hash__ = None  # type: ignore[assignment]

    def __bool__(self) -> bool:
        raise RuntimeError("neither true nor false")

    @property
    def code(self) -> int:
        raise AssertionError("a property is code, and code is not run")


class Seen:
    """A blackboard and figures, by plain assignment."""

    def __init__(self, **entries: object) -> None:
        self.entries: dict[str, object] = {
            "goal": Waypoint(Pose2(3.0, -1.0, 0.5), "view", expected_gain_m2=0.7),
            "visited": (1, 2, 3),
            "failure": "held",
            "colour": Colour.RED,
            "grid": np.zeros((3, 4)),
            "count": np.int64(7),
            "board": {"a": 1},
            "trap": Trap(),
            "nothing": None,
        } | entries

    def name(self, name: str) -> object:
        return {"tick": 12, "time": 1.5, "x": 2.0, "y": -1.0, "coverage": None, "robot": "r"}[name]

    def entry(self, key: str) -> object:
        return self.entries.get(key)


def value(text: str) -> object:
    return Expression(text).value(Seen())


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("$goal.pose.x", 3.0),
        ("$goal.pose.x - x > 0.5 and time < 2", True),
        ("-1 <= y < 0", True),
        ("$visited.size", 3),
        ("$visited[0] + $visited[-1]", 4),
        ("$visited[9]", None),
        ("2 in $visited", True),
        ("'a' in $board and $board['a'] == 1", True),
        ("$failure == 'held'", True),
        ('$failure in "held, lost"', True),
        ("'$goal' == '$goal'", True),
        ("$colour == 'red'", True),
        ("$count // 2", 3),
        ("$grid.size", 12),
        ("not $nothing", True),
        ("$nothing is none", True),
        ("$nobody.pose.x > 3", False),
        ("$nobody.pose.x == None", True),
        ("coverage < 0.5", False),
        ("true and not false", True),
        ("-(1 + 2) * 3 % 5 / 2", 0.5),
    ],
)
def test_an_expression_is_worth_what_one_reads(text, expected):
    assert value(text) == expected


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        ("", "an empty expression"),
        ("print(1)", "column 1: a call is not allowed"),
        ("$goal.__class__", "column 1: .__class__ is not a field"),
        ("__import__('os')", "column 1: __import__ is not known"),
        ("1 + _goal", "column 5: _goal is not known"),
        ("[n for n in $visited]", "a comprehension is not allowed"),
        ("lambda: 1", "a lambda is not allowed"),
        ("f'{x}'", "an f-string is not allowed"),
        ("1 if x else 2", "if ... else is not allowed"),
        ("x := 3", "column 3"),
        ("9 ** 9", "column 1: ** is not allowed"),
        ("1 << 3", "column 1: << is not allowed"),
        ("~x", "column 1: ~ is not allowed; write not"),
        ("x >", "column 4: not an expression"),
        ("tcik > 3", 'column 1: there is no name "tcik"; did you mean "tick"?; an entry is written $tcik'),
        ("'°äµ' == print(1)", "column 10: a call is not allowed"),
        ("x == 3j", "column 6: is not allowed"),
        ("b'a' == x", "column 1: is not allowed"),
        ("x\n> 3", "no line break"),
        ("'a\\x41'", "no backslash"),
        ("1" * 301, "301 characters; at most 300"),
        ("not " * 40 + "x", "more than 30 levels deep"),
        ("(" * 250 + "x" + ")" * 40, "column"),
        ("$visited[0:2]", "a slice is not allowed"),
    ],
)
def test_what_is_not_allowed_is_refused_before_anything_is_evaluated(text, complaint):
    with pytest.raises(ExpressionError) as refusal:
        Expression(text)
    assert complaint in str(refusal.value)


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        ("1 / 0", "column 1: ZeroDivisionError"),
        ("$failure * 3", "column 1: str held is not a number"),
        ("1 + 'a'", "column 5: str a is not a number"),
        ("$visited * 1000000", "is not a number"),
        ("$goal.pse", 'column 1: Waypoint has no field pse; did you mean "pose"?'),
        ("$trap.code", "column 1: Trap has no field code"),
        ("$trap == $goal", "column 1: RuntimeError: not to be compared"),
        ("$grid == 3", "an array cannot be compared; compare its .size"),
        ("not $grid", "an array is neither true nor false"),
        ("3 in $count", "column 6: int 7 cannot be searched"),
        ("$failure < 3", "TypeError"),
        ("$board[$goal]", "has no [Waypoint]"),
    ],
)
def test_what_has_no_value_says_where_and_why(text, complaint):
    with pytest.raises(ExpressionError) as fault:
        value(text)
    assert complaint in str(fault.value)


@pytest.mark.parametrize("text", ["$trap", "not $trap", "$trap and true", "$grid"])
def test_what_is_neither_true_nor_false_says_so(text):
    with pytest.raises(ExpressionError, match="neither true nor false"):
        Expression(text).holds(Seen())


def test_a_long_list_is_not_searched():
    with pytest.raises(ExpressionError, match="cannot be searched"):
        Expression("3 in $long").value(Seen(long=range(10_001)))


@given(st.text(max_size=60) | st.text("$goalxy.()[]'\"+-*/%<>=! 0123andornt_,:{}", max_size=60))
def test_whatever_is_typed_gives_a_value_or_a_clear_refusal(text):
    with contextlib.suppress(ExpressionError):  # any other exception would be a fault
        value(text)


comparisons = st.sampled_from(["<", "<=", ">", ">=", "==", "!="])
junctions = st.sampled_from(["and", "or"])
numbers = st.sampled_from(["0", "1", "2.5", "7", "x", "y", "tick", "time"])
arithmetic = st.recursive(
    numbers,
    lambda inner: st.builds(
        lambda a, op, b: f"({a} {op} {b})", inner, st.sampled_from(["+", "-", "*", "/", "//", "%"]), inner
    ),
    max_leaves=8,
)
logic = st.recursive(
    st.builds(lambda a, op, b: f"{a} {op} {b}", arithmetic, comparisons, numbers),
    lambda inner: (
        st.builds(lambda a, op, b: f"(({a}) {op} ({b}))", inner, junctions, inner)
        | st.builds(lambda a: f"(not ({a}))", inner)
    ),
    max_leaves=4,
)


@given(logic)
def test_an_expression_means_what_python_means(text):
    names: dict[str, Any] = {"x": 2.0, "y": -1.0, "tick": 12, "time": 1.5}
    assume(len(text) <= LONGEST)
    expression = Expression(text)
    try:
        expected = eval(text, {"__builtins__": {}}, names)
    except ZeroDivisionError:
        with pytest.raises(ExpressionError, match="ZeroDivisionError"):
            expression.value(Seen())
        return
    assert expression.value(Seen()) == expected


def test_no_number_grows_longer_than_what_was_written():
    product = value("*".join(["9" * 10] * 27))
    assert isinstance(product, int)
    assert product < 10**LONGEST
