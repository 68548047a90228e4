"""Small words for messages: suggestions and how values are shown."""

from __future__ import annotations

import difflib
import math
from collections.abc import Iterable
from pathlib import Path

from explore_bt.tree import Key
from explore_bt.units import Dimension

__all__ = ["alternatives", "did_you_mean", "listed", "pose", "quantity", "show"]

_SHOWN = 12
_LONGEST = 60


def did_you_mean(word: str, known: Iterable[str], what: str = "known") -> str:
    """The likeliest spelling, or the list of what there is."""
    names = list(known)
    near = difflib.get_close_matches(word, names, n=1) or [n for n in names if n.lower() == word.lower()]
    return f'did you mean "{near[0]}"?' if near else listed(names, what)


def listed(names: Iterable[str], what: str) -> str:
    """``known: a, b, c``; long lists are cut."""
    every = sorted(names)
    if not every:
        return f"{what}: none"
    rest = f" and {len(every) - _SHOWN} more" if len(every) > _SHOWN else ""
    return f"{what}: {', '.join(every[:_SHOWN])}{rest}"


def alternatives(words: Iterable[str]) -> str:
    """``a, b or c``."""
    every = list(words)
    return " or ".join(filter(None, (", ".join(every[:-1]), *every[-1:])))


def show(value: object) -> str:
    """A value as it would stand in a mission file."""
    text = _show(value)
    return text if len(text) <= _LONGEST else f"{text[: _LONGEST - 3]}..."


def _show(value: object) -> str:
    if isinstance(value, Key):
        return f"${value.name}"
    if value is None:
        return "null"
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, float):
        return f"{value:g}"
    if isinstance(value, list | tuple):
        return f"[{', '.join(map(_show, value))}]"
    if isinstance(value, dict):
        return f"{{{', '.join(f'{key}: {_show(each)}' for key, each in value.items())}}}"
    return str(value) if isinstance(value, str | int | Path) else type(value).__name__


def pose(x: float, y: float, yaw_rad: float) -> str:
    """``[1 m, 2 m, 90 deg]``."""
    return f"[{x:g} m, {y:g} m, {math.degrees(yaw_rad):g} deg]"


def quantity(value: object, dimension: Dimension | None) -> str:
    """A number in the units people think in: degrees for angles, SI for the rest."""
    if dimension is None or isinstance(value, bool) or not isinstance(value, int | float):
        return show(value)
    if dimension.si.startswith("rad"):
        return f"{math.degrees(value):g} {dimension.si.replace('rad', 'deg')}"
    return f"{value:g} {dimension.si}"
