"""Values of a mission against the types that plugins and leaves declare."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TypeVar

from pydantic import BaseModel, ValidationError
from pydantic_core import ErrorDetails

from explore_bt.mission.bounds import Asked, asked_by_field
from explore_bt.mission.document import Entries, Entry, Scalar, Value
from explore_bt.mission.faults import Faults
from explore_bt.mission.references import BROKEN, is_broken, plain_data
from explore_bt.mission.source import Place
from explore_bt.mission.wording import group_by_value, refusal
from explore_bt.mission.words import did_you_mean, show
from explore_bt.tree import Key

__all__ = ["check_model", "check_value", "find_key"]

M = TypeVar("M", bound=BaseModel)
Validate = Callable[[str], object]


def check_value(validate: Validate, value: Value, label: str, asked: Asked, faults: Faults) -> object:
    """The validated value, or ``BROKEN`` with its faults noted.

    Args:
        validate: takes JSON text and raises ``ValidationError``. In strict mode JSON is what YAML data is:
            lists may be tuples and text may be an enum, but text is never a number.
        value: constants resolved.
        label: what the message begins with.
        asked: dimension and bounds, for the wording.
        faults: where to note what is wrong.
    """
    if is_broken(value):
        return BROKEN
    try:
        return validate(_json(plain_data(value)))
    except ValidationError as error:
        for found, way, errors in group_by_value(error.errors(include_url=False), value):
            message, hint = refusal(errors, found, asked)
            faults.add(found.place, f"{'.'.join([label, *map(str, way)])}: {message}", hint)
    except Exception as error:  # a plugin's own validator may raise anything
        faults.add(value.place, f"{label}: {error}")
    return BROKEN


def _json(data: object) -> str:
    return json.dumps(data, default=lambda each: str(each) if isinstance(each, Path) else show(each))


def check_model(
    model: type[M], entries: Entries, owner: str, what: str, folder: Path, faults: Faults, head: Place
) -> M | None:
    """A mapping as the options of a plugin, or as one of the mission's own sections.

    Args:
        model: the pydantic model.
        entries: constants resolved; an entry whose value is a parameter that was not given is left out.
        owner: whose options they are, for messages.
        what: ``option`` or ``key``.
        folder: what relative files are relative to.
        faults: where to note what is wrong.
        head: where to note what is missing.
    """
    given = [entry for entry in entries if not is_broken(entry.value) and not _not_given(entry.value)]
    broken = {entry.key for entry in entries if is_broken(entry.value)}
    keyed = [entry for entry in given if _noted_entry(entry, owner, what, faults)]
    kept = Entries(tuple(entry for entry in given if entry not in keyed), entries.place)
    silent = broken | {entry.key for entry in keyed}
    try:
        checked = model.model_validate_json(
            _json(plain_data(kept)), strict=True, context={"base_dir": folder, "must_exist": True}
        )
    except ValidationError as error:
        told = [each for each in error.errors(include_url=False) if not set(each["loc"][:1]) & silent]
        _tell(told, model, kept, owner, what, faults, head)
        return None
    except Exception as error:  # a plugin's own validator may raise anything
        faults.add(head, f"{owner}: {error}")
        return None
    return None if silent else checked


def _not_given(value: Value) -> bool:
    return isinstance(value, Scalar) and value.data is None and value.text.startswith("$")


def _noted_entry(entry: Entry, owner: str, what: str, faults: Faults) -> bool:
    """Whether ``entry`` names a blackboard entry, which no option can (the fault is noted then)."""
    key = find_key(entry.value)
    if key is None:
        return False
    message = f"{owner}.{entry.key}: {key.text} is a blackboard entry; an {what} is a constant"
    faults.add(key.place, message, f"write $params.{key.text[1:]} and declare it under params:")
    return True


def find_key(value: Value) -> Scalar | None:
    """The first ``$entry`` in ``value``."""
    if isinstance(value, Scalar):
        return value if isinstance(value.data, Key) else None
    parts = [each.value for each in value] if isinstance(value, Entries) else list(value.values)
    return next(filter(None, map(find_key, parts)), None)


def _tell(
    errors: list[ErrorDetails],
    model: type[BaseModel],
    entries: Entries,
    owner: str,
    what: str,
    faults: Faults,
    head: Place,
) -> None:
    fields = model.model_fields
    names = {field.alias or name: field for name, field in fields.items()}
    rest: list[ErrorDetails] = []
    for error in errors:
        loc = error["loc"]
        if error["type"] == "extra_forbidden" and len(loc) == 1:
            message = f'{owner} has no {what} "{loc[0]}"'
            faults.add(
                entries.by_key[str(loc[0])].place, message, did_you_mean(str(loc[0]), names, f"{what}s")
            )
        elif error["type"] == "missing" and len(loc) == 1:
            doc = names[str(loc[0])].description or ""
            faults.add(head, f'{owner} needs the {what} "{loc[0]}"', f"{loc[0]}: {doc}" if doc else "")
        else:
            rest.append(error)
    asked: Mapping[str, Asked] = (
        {name: asked_by_field(field.annotation, field.metadata) for name, field in names.items()}
        if rest
        else {}
    )
    for found, way, group in group_by_value(rest, entries):
        message, hint = refusal(group, found, asked.get(str(way[0]), Asked()) if way else Asked())
        label = ".".join(map(str, way)) if way else owner
        faults.add(
            found.place if way else head, f"{label}: {message}" if way else f"{owner}: {message}", hint
        )
