"""From typed words to commands."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass

from explore_bt.debug.breakpoint import STATUSES, Breakpoint, Moment
from explore_bt.debug.commands import Force, Step, StepKind
from explore_bt.errors import DebugError
from explore_bt.mission.words import did_you_mean

__all__ = ["Span", "breakpoint_of", "force_of", "number_of", "span_of", "step_of", "words_of"]

_WORD = re.compile(r""""(?P<double>[^"]*)"|'(?P<single>[^']*)'|(?P<bare>\S+)""")
_FORCED = ("success", "failure")


@dataclass(frozen=True, slots=True)
class _Word:
    text: str
    end: int
    is_quoted: bool


@dataclass(frozen=True, slots=True)
class Span:
    """So many ticks, or so many seconds."""

    ticks: int = 0
    seconds: float = 0.0


def words_of(rest: str) -> list[str]:
    """The words of a line; quotes hold words together."""
    return [word.text for word in _split(rest)]


def number_of(text: str, what: str) -> int:
    """A whole number from 0 on.

    Raises:
        DebugError: it is none.
    """
    if not re.fullmatch(r"\d{1,9}", text):
        raise DebugError(f'"{text}" is not {what}; write a whole number')
    return int(text)


def step_of(rest: str) -> Step:
    """``[N] [tick|node|change] [robot NAME]`` in any order."""
    count, kind, robot = 1, StepKind.TICK, "*"
    words = _split(rest)
    for word in (each.text for each in words):
        if word == "robot":
            robot = _next(words, "which robot?")
            continue
        if word[:1].isdigit():
            count = number_of(word, "a number of steps")
            continue
        name = word.lower().removesuffix("s")
        if name not in list(StepKind):
            raise DebugError(f'there is no step "{word}"; {did_you_mean(name, StepKind, "steps")}')
        kind = StepKind(name)
    return Step(kind, count, robot)


def span_of(rest: str) -> Span:
    """``N`` ticks, or ``N s``; one tick if nothing is said.

    Raises:
        DebugError: neither.
    """
    text = rest.strip()
    if not text:
        return Span(ticks=1)
    if found := re.fullmatch(r"(\d{1,7}(?:\.\d+)?)\s*s", text):
        return Span(seconds=float(found[1]))
    return Span(ticks=number_of(text, "a number of ticks, or seconds as in: back 30 s"))


def breakpoint_of(rest: str) -> Breakpoint:
    """``PATH [before|after] [STATUS] [ignore N] [once] [robot NAME] [if EXPRESSION]``."""
    words = _split(rest)
    path = next(words, None)
    if path is None:
        raise DebugError("break where? For example: break drive_to failure")
    found = _Break(path.text)
    for word in words:
        text = word.text.lower()
        if text == "if" and not word.is_quoted:
            found.condition = rest[word.end :].strip()
            if not found.condition:
                raise DebugError("if what? For example: break drive_to if $goal.expected_gain_m2 < 1")
            break
        if text in list(Moment):
            found.moment = Moment(text)
        elif text in STATUSES:
            found.status = text
        elif text == "once":
            found.once = True
        elif text == "ignore":
            found.ignore = number_of(_next(words, "ignore how many hits?"), "a number of hits")
        elif text == "robot":
            found.robot = _next(words, "which robot?")
        else:
            known = (*Moment, *STATUSES, "once", "ignore", "robot", "if")
            raise DebugError(f'"{word.text}" is not understood here; {did_you_mean(text, known, "words")}')
    moment = found.moment or (Moment.BEFORE if found.status == "idle" else Moment.AFTER)
    return Breakpoint(
        found.path, moment, found.status, found.condition, found.robot, found.ignore, found.once
    )


def force_of(rest: str) -> Force:
    """``PATH success|failure [once] [robot NAME]``."""
    words = _split(rest)
    path, status = next(words, None), next(words, None)
    if path is None or status is None:
        raise DebugError("force what, to what? For example: force drive_to failure once")
    if status.text.lower() not in _FORCED:
        hint = did_you_mean(status.text.lower(), _FORCED, "answers")
        raise DebugError(f'a node cannot be forced to "{status.text}"; {hint}')
    once, robot = False, "*"
    for word in words:
        if word.text == "once":
            once = True
        elif word.text == "robot":
            robot = _next(words, "which robot?")
        else:
            hint = did_you_mean(word.text, ("once", "robot"), "words")
            raise DebugError(f'"{word.text}" is not understood here; {hint}')
    return Force(path.text, status.text.lower(), once, robot)


@dataclass(slots=True)
class _Break:
    path: str
    moment: Moment | None = None
    status: str = ""
    condition: str = ""
    robot: str = "*"
    ignore: int = 0
    once: bool = False


def _split(rest: str) -> Iterator[_Word]:
    for found in _WORD.finditer(rest):
        quoted = found["double"] if found["double"] is not None else found["single"]
        yield _Word(found["bare"] if quoted is None else quoted, found.end(), quoted is not None)


def _next(words: Iterator[_Word], question: str) -> str:
    word = next(words, None)
    if word is None:
        raise DebugError(question)
    return word.text
