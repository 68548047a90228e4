"""Values of ports as XML attributes: SI, ``{key}`` for a blackboard entry, ``;`` between items of a list."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from explore_bt.mission.document import Items, Scalar, Value
from explore_bt.mission.scalars import plain_scalar
from explore_bt.mission.source import Place
from explore_bt.tree import Input, Key, Output

__all__ = ["attribute_text", "entry_name", "port_value"]


def attribute_text(value: object) -> str:
    """A bound value as the text of an attribute.

    Raises:
        ValueError: a value that no attribute can hold.
    """
    if isinstance(value, list | tuple):
        parts = [attribute_text(each) for each in value]
        if len(parts) < 2 or any(
            ";" in part or isinstance(each, list | tuple) for part, each in zip(parts, value, strict=True)
        ):
            raise ValueError(f"the list {list(value)}")
        return ";".join(parts)
    if isinstance(value, Key):
        return f"{{{value.name}}}"
    if isinstance(value, bool) or value is None:
        return json.dumps(value)
    if isinstance(value, str):
        if value.startswith("$") or entry_name(value):
            raise ValueError(f"the text {value}")
        return value
    if isinstance(value, int | float | Path):
        return repr(value) if isinstance(value, float) else str(value)
    raise ValueError(f"a {type(value).__name__}")


def entry_name(text: str) -> str:
    """``goal`` for ``{goal}``; empty where ``text`` names no blackboard entry."""
    return text[1:-1].strip() if len(text) > 2 and text[0] == "{" and text[-1] == "}" else ""


def port_value(text: str, port: Input[Any] | Output[Any] | None, place: Place) -> Value:
    """An attribute as it would stand in a mission: the first reading that the port takes.

    Where it takes none, the plain reading is returned and the loader says what is wrong with it.
    """
    name = entry_name(text)
    if name:
        return Scalar(f"${name}", f"${name}", True, place)
    plain = Scalar(plain_scalar(text), text, True, place)
    quoted = Scalar(text, text, False, place)
    if not isinstance(port, Input) or not port.takes_constants:
        return quoted
    readings: list[Value] = [plain, quoted]
    if ";" in text:
        items = [Scalar(plain_scalar(part), part, True, place) for part in text.split(";")]
        readings.append(Items(tuple(items), place))
    return next((reading for reading in readings if _takes(port, reading)), plain)


def _takes(port: Input[Any], value: Value) -> bool:
    data = (
        [each.data for each in value.values if isinstance(each, Scalar)] if isinstance(value, Items) else None
    )
    if isinstance(value, Scalar):
        data = value.data  # type: ignore[assignment]  # any JSON value
    try:
        port.adapter.validate_json(
            json.dumps(data), strict=True, context={"base_dir": value.place.source.folder}
        )
    except Exception:  # a plugin's own validator may raise anything
        return False
    return True
