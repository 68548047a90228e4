"""pydantic's errors in the words of a mission author."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from pydantic_core import ErrorDetails

from explore_bt.mission.bounds import Asked
from explore_bt.mission.document import Entries, Items, Scalar, Value
from explore_bt.mission.reading import written
from explore_bt.mission.words import alternatives, did_you_mean, quantity, show

__all__ = ["group_by_value", "refusal"]

_SWITCHES: Mapping[str, str] = {
    **dict.fromkeys(("yes", "on", "y", "1"), "write true"),
    **dict.fromkeys(("no", "off", "n", "0"), "write false"),
}
_BOUNDS = ("greater_than", "less_than", "finite_number")
_NOUNS: Mapping[str, tuple[str, str]] = {
    "int_type": ("a whole number", ""),
    "int_parsing": ("a whole number", ""),
    "int_from_float": ("a whole number", ""),
    "float_type": ("a number", ""),
    "float_parsing": ("a number", ""),
    "bool_type": ("true or false", ""),
    "bool_parsing": ("true or false", ""),
    "string_type": ("text", "put it in quotes"),
    "list_type": ("a list", "write [a, b]"),
    "tuple_type": ("a list", "write [a, b]"),
    "set_type": ("a list", "write [a, b]"),
    "dict_type": ("a mapping", "write {name: value}"),
    "model_type": ("a mapping", "write {name: value}"),
    "model_attributes_type": ("a mapping", "write {name: value}"),
    "none_required": ("null", ""),
}


@dataclass(frozen=True, slots=True)
class _Wanted:
    noun: str
    hint: str


def group_by_value(
    errors: Sequence[ErrorDetails], value: Value
) -> list[tuple[Value, tuple[str | int, ...], list[ErrorDetails]]]:
    """Errors by the value they are about, with the way to it: a union's errors come together."""
    groups: dict[tuple[str | int, ...], tuple[Value, list[ErrorDetails]]] = {}
    for error in errors:
        found, way = _descend(value, error["loc"])
        found = _blamed(found, error)
        groups.setdefault(way, (found, []))[1].append(error)
    return [(found, way, each) for way, (found, each) in groups.items()]


def _descend(value: Value, loc: tuple[str | int, ...]) -> tuple[Value, tuple[str | int, ...]]:
    """The value at ``loc``; parts of it that name a branch of a union are passed over."""
    way: list[str | int] = []
    for part in loc:
        if isinstance(value, Entries) and part in value.by_key:
            value = value.by_key[str(part)].value
        elif isinstance(value, Items) and isinstance(part, int) and part < len(value.values):
            value = value.values[part]
        else:
            continue
        way.append(part)
    return value, tuple(way)


def _blamed(value: Value, error: ErrorDetails) -> Value:
    """The item of a list that a validator of the whole list complains about, if it names one."""
    if isinstance(value, Items) and error["type"] == "value_error":
        sentence = str((error.get("ctx") or {}).get("error", ""))
        for item in value.values:
            if isinstance(item, Scalar) and sentence.startswith(f"{show(item.data)} is not "):
                return item
    return value


def refusal(errors: Sequence[ErrorDetails], value: Value, asked: Asked) -> tuple[str, str]:
    """What is wrong with one value, and a hint: ``30 is not a length ...``, ``write 0.30 m or 30 cm``."""
    if _is_braced_name(value):
        assert isinstance(value, Entries)  # just tested
        name = value.entries[0].key
        return f"{{{name}}} is a YAML mapping", f"write ${name}"
    wants = list(dict.fromkeys(_wanted(error, value, asked) for error in errors))
    nouns = alternatives(dict.fromkeys(want.noun for want in wants if want.noun))
    hints = [want.hint for want in wants if want.hint]
    if not nouns:
        sentence = errors[0]["msg"].removeprefix("Value error, ").partition("; ")[0]
        return sentence[0].lower() + sentence[1:], hints[0] if hints else ""
    return f"{_found(value, asked)} is not {nouns}", hints[0] if hints else ""


def _is_braced_name(value: Value) -> bool:
    if not isinstance(value, Entries) or len(value.entries) != 1:
        return False
    only = value.entries[0].value
    return isinstance(only, Scalar) and only.data is None and only.text == ""


def _found(value: Value, asked: Asked) -> str:
    if not isinstance(value, Scalar):
        return written(value)
    if value.text.startswith("$"):
        return f"{quantity(value.data, asked.dimension)} ({value.text})"
    return show(value.text) if value.text else "null"


def _wanted(error: ErrorDetails, value: Value, asked: Asked) -> _Wanted:
    kind, context = error["type"], error.get("ctx") or {}
    if kind in ("literal_error", "enum"):
        choices = re.findall(r"'([^']*)'", str(context.get("expected", ""))) or [str(context.get("expected"))]
        near = did_you_mean(value.text, choices, "one of") if isinstance(value, Scalar) and value.text else ""
        return _Wanted(alternatives(f'"{choice}"' for choice in choices), near if "?" in near else "")
    if kind.startswith(_BOUNDS):
        return _Wanted(_bounded(context, asked), _unit_hint(value, asked))
    if kind in _NOUNS:
        noun, hint = _NOUNS[kind]
        if noun == "true or false" and isinstance(value, Scalar):
            hint = _SWITCHES.get(value.text.lower(), hint)
        return _Wanted(noun, hint)
    if kind in ("value_error", "assertion_error"):
        return _own_words(str(context.get("error", error["msg"])))
    return _Wanted("", "")


def _own_words(message: str) -> _Wanted:
    """A validator's sentence ``X is not a Y; write Z`` taken apart."""
    sentence, _, hint = message.partition("; ")
    _, negated, noun = sentence.partition(" is not ")
    return _Wanted(noun if negated else "", hint)


def _bounded(context: Mapping[str, object], asked: Asked) -> str:
    if asked.range:
        return asked.noun
    words = {"ge": "of at least", "le": "of at most", "gt": "above", "lt": "below"}
    for name, word in words.items():
        if name in context:
            return f"a number {word} {show(context[name])}"
    return "a finite number"


def _unit_hint(value: Value, asked: Asked) -> str:
    bare = (
        isinstance(value, Scalar) and isinstance(value.data, int | float) and not value.text.startswith("$")
    )
    return f"write {asked.dimension.example}" if bare and asked.dimension else ""
