"""What the leaves saw when they decided, as a message."""

from __future__ import annotations

import json
import math
from dataclasses import fields

from explore_bt.recording.foxglove import time_json
from explore_bt.types import Drawing

__all__ = ["drawing_message"]

_MOST_MARKS = 64
_DECIMALS = 3


def drawing_message(time_ns: int, drawing: Drawing) -> str:
    """``explore_bt.Drawing``: metres and radians to three decimals, at most 64 marks a layer.

    ``left_out`` says how many of a layer's are missing; it names no layer that is whole.
    """
    layers = drawing.layers()
    shown = {name: [_mark(mark) for mark in marks[:_MOST_MARKS]] for name, marks in layers.items()}
    left_out = {name: more for name, marks in layers.items() if (more := len(marks) - _MOST_MARKS) > 0}
    texts = (
        f'"{name}":{json.dumps(value, ensure_ascii=False, separators=(",", ":"))}'
        for name, value in (("layers", shown), ("left_out", left_out))
    )
    return f'{{"timestamp":{time_json(time_ns)},{",".join(texts)}}}'


def _mark(mark: object) -> dict[str, object]:
    values = ((field.name, getattr(mark, field.name)) for field in fields(mark))  # type: ignore[arg-type]  # marks are dataclasses
    return {name: _figure(value) if isinstance(value, float) else value for name, value in values}


def _figure(value: float) -> float | None:
    return round(value, _DECIMALS) if math.isfinite(value) else None
