"""Blackboard values as JSON: explicit, bounded in size, and the same text for the same value."""

from __future__ import annotations

import dataclasses
import enum
import math
from collections.abc import Mapping, Sequence, Set
from functools import lru_cache
from pathlib import PurePath

import numpy as np
from numpy.typing import NDArray

__all__ = ["to_json"]

MAX_ITEMS = 32
"""Longer sequences and arrays are told by their length, their ends and their range."""
MAX_TEXT = 2000
MAX_DEPTH = 6
DECIMALS = 6


def to_json(value: object, depth: int = 0) -> object:
    """A value as ``json`` takes it: None, bool, int, float, str, list and dict, all finite.

    Dataclasses become objects that name their class under ``class``; infinite and undefined numbers
    become the texts ``inf``, ``-inf``, ``nan``; of a class nobody described here only the name is told,
    because its ``repr`` may hold an address and two runs would differ.
    """
    if type(value) is float:  # nearly all there is
        return _number(value)
    if value is None or isinstance(value, bool | np.bool_):
        return None if value is None else bool(value)
    if isinstance(value, enum.Enum):
        return to_json(value.value, depth)
    if isinstance(value, int | np.integer):
        return int(value)
    if isinstance(value, float | np.floating):
        return _number(float(value))
    if isinstance(value, str | PurePath):
        return _text(str(value))
    if isinstance(value, np.ndarray):
        return _array(value)
    if depth >= MAX_DEPTH:
        return {"class": type(value).__name__}
    return _compound(value, depth + 1)


@lru_cache
def _field_names(cls: type) -> tuple[str, ...]:
    """Of a dataclass; asking anew for every waypoint of a run would cost a tenth of the recorder."""
    return tuple(field.name for field in dataclasses.fields(cls))


def _number(value: float) -> float | str:
    return round(value, DECIMALS) if math.isfinite(value) else str(value)


def _text(value: str) -> str:
    return value if len(value) <= MAX_TEXT else f"{value[:MAX_TEXT]}… ({len(value)} characters)"


def _array(array: NDArray[np.generic]) -> object:
    if array.size <= MAX_ITEMS:
        return to_json(array.tolist(), MAX_DEPTH - 3)
    summary: dict[str, object] = {"class": "ndarray", "dtype": str(array.dtype), "shape": list(array.shape)}
    if np.issubdtype(array.dtype, np.number):
        summary |= {"min": to_json(array.min()), "max": to_json(array.max())}
    return summary


def _compound(value: object, depth: int) -> object:
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        described = {name: to_json(getattr(value, name), depth) for name in _field_names(type(value))}
        return {"class": type(value).__name__, **described}
    if isinstance(value, Mapping):
        shown = list(value.items())[:MAX_ITEMS]
        left_out = {"…": f"{len(value)} entries"} if len(value) > MAX_ITEMS else {}
        return {str(to_json(key, depth)): to_json(item, depth) for key, item in shown} | left_out
    if isinstance(value, Set):
        return _sequence(sorted(value, key=repr), depth)
    if isinstance(value, Sequence):
        return _sequence(value, depth)
    return {"class": type(value).__name__}


def _sequence(items: Sequence[object], depth: int) -> object:
    if len(items) <= MAX_ITEMS:
        return [to_json(item, depth) for item in items]
    return {
        "class": "sequence",
        "length": len(items),
        "first": to_json(items[0], depth),
        "last": to_json(items[-1], depth),
    }
