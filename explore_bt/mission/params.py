"""Parameters: declared types, defaults and bounds; values from the mission or from ``--set``."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Annotated, Any

from pydantic import Field, TypeAdapter

from explore_bt.mission.bounds import Asked, dimension_of
from explore_bt.mission.catalog import PluginCatalog
from explore_bt.mission.checking import check_value, find_key
from explore_bt.mission.document import Entries, Entry, Scalar, Value
from explore_bt.mission.faults import Faults
from explore_bt.mission.reading import check_keys, expect_entries, expect_items, expect_text, written
from explore_bt.mission.references import BROKEN, NAME, Scope, plain_data, resolve
from explore_bt.mission.words import did_you_mean, listed
from explore_bt.units import (
    Acceleration,
    Angle,
    AngularAcceleration,
    AngularJerk,
    AngularRate,
    Area,
    Duration,
    FilePath,
    Frequency,
    Jerk,
    Length,
    PoseTriple,
    Speed,
)

__all__ = ["PARAM_KEYS", "PARAM_TYPES", "PLUGIN_KINDS", "Param", "param_value", "read_param"]

PARAM_TYPES: Mapping[str, Any] = {
    "length": Length,
    "angle": Angle,
    "duration": Duration,
    "speed": Speed,
    "area": Area,
    "acceleration": Acceleration,
    "jerk": Jerk,
    "angular_rate": AngularRate,
    "angular_acceleration": AngularAcceleration,
    "angular_jerk": AngularJerk,
    "frequency": Frequency,
    "number": float,
    "integer": int,
    "boolean": bool,
    "text": str,
    "choice": str,
    "file": FilePath,
    "pose": PoseTriple,
    "plugin": str,
}
"""Name in a mission -> what its values are validated against."""

PLUGIN_KINDS = (
    "driver",
    "slam",
    "planner",
    "controller",
    "team",
    "allocator",
    "sink",
    "exporter",
    "behaviour",
)
PARAM_KEYS = ("type", "default", "min", "max", "choices", "kind", "doc")
_TEXTS = ("text", "choice", "file", "plugin")


@dataclass(frozen=True, slots=True)
class Param:
    """A declared parameter; ``default`` is None if every run has to give it."""

    name: str
    type: str
    entry: Entry
    default: Value | None
    asked: Asked = Asked()
    choices: tuple[str, ...] = ()
    kind: str = ""
    doc: str = ""


def read_param(entry: Entry, faults: Faults) -> Param | None:
    """One declaration; None where its type is not known."""
    name = entry.key
    example = f"{name}: {{type: length, default: 1 m}}"
    if not NAME.fullmatch(name):
        faults.add(entry.place, f'"{name}" is no name for a parameter', "letters, digits and underscores")
    entries = expect_entries(entry.value, f"params.{name}", example, faults)
    if entries is None:
        if isinstance(entry.value, Scalar) and entry.value.data is None:
            faults.add(entry.place, f"params.{name} has no type", f"write {example}")
        return None
    check_keys(entries, PARAM_KEYS, f"params.{name}", faults)
    kind = expect_text(entries.get("type"), f"params.{name}.type", faults)
    if kind is None:
        faults.add(entry.place, f"params.{name} has no type", listed(PARAM_TYPES, "types"))
        return None
    if kind not in PARAM_TYPES:
        place = entries.by_key["type"].value.place
        faults.add(place, f'there is no parameter type "{kind}"', did_you_mean(kind, PARAM_TYPES, "types"))
        return None
    param = Param(
        name,
        kind,
        entry,
        entries.get("default"),
        doc=expect_text(entries.get("doc"), f"params.{name}.doc", faults) or "",
    )
    return _with_details(param, entries, faults)


def _with_details(param: Param, entries: Entries, faults: Faults) -> Param:
    label = f"params.{param.name}"
    type_ = PARAM_TYPES[param.type]
    bounds: dict[str, float | None] = {}
    for key, bound in (("min", "ge"), ("max", "le")):
        value = entries.get(key)
        if value is None:
            continue
        if type_ not in (float, int) and dimension_of(type_) is None:
            faults.add(entries.by_key[key].place, f"{label}: a {param.type} has no {key}", f"remove {key}")
            continue
        number = _checked(type_, value, f"{label}.{key}", Asked(dimension_of(type_)), faults)
        bounds[bound] = number if isinstance(number, int | float) else None
    choices = tuple(
        str(plain_data(each))
        for each in expect_items(entries.get("choices"), f"{label}.choices", "[a, b]", faults)
    )
    kind = expect_text(entries.get("kind"), f"{label}.kind", faults) or ""
    if param.type == "choice" and not choices:
        faults.add(param.entry.place, f"{label}: a choice needs choices", "write choices: [a, b]")
    if param.type == "plugin" and kind not in PLUGIN_KINDS:
        place = entries.by_key["kind"].value.place if kind else param.entry.place
        message = f'there is no plugin kind "{kind}"' if kind else f"{label}: a plugin needs a kind"
        faults.add(place, message, did_you_mean(kind, PLUGIN_KINDS, "kinds"))
    return replace(param, asked=Asked(dimension_of(type_), **bounds), choices=choices, kind=kind)


def _checked(type_: Any, value: Value, label: str, asked: Asked, faults: Faults) -> object:
    if asked.ge is not None or asked.le is not None:
        type_ = Annotated[type_, Field(ge=asked.ge, le=asked.le)]
    adapter: TypeAdapter[object] = TypeAdapter(type_)
    context = {"base_dir": value.place.source.folder}
    return check_value(
        lambda text: adapter.validate_json(text, strict=True, context=context), value, label, asked, faults
    )


def param_value(
    param: Param, override: Value | None, catalog: PluginCatalog, environ: Mapping[str, str], faults: Faults
) -> object:
    """The value in SI; None where the parameter is not given, ``BROKEN`` where a fault was noted."""
    given = override or param.default
    if given is None:
        hint = f"--set {param.name}=..., or give it a default"
        faults.add(param.entry.place, f"params.{param.name} has no value", hint)
        return BROKEN
    if isinstance(given, Scalar) and override is not None and param.type in _TEXTS and given.data is not None:
        given = replace(given, data=given.text)
    value = resolve(given, Scope({}, environ), faults)
    if isinstance(value, Scalar) and value.data is None:
        return None
    if key := find_key(value):
        faults.add(key.place, f"{param.name}: {key.text} is a blackboard entry; a parameter is a constant")
        return BROKEN
    if param.type in ("choice", "plugin"):
        return _one_of(param, value, catalog, faults)
    return _checked(PARAM_TYPES[param.type], value, param.name, param.asked, faults)


def _one_of(param: Param, value: Value, catalog: PluginCatalog, faults: Faults) -> object:
    if not (param.choices or param.kind in PLUGIN_KINDS):
        return BROKEN
    known = catalog.names(param.kind) if param.type == "plugin" else param.choices
    text = str(value.data) if isinstance(value, Scalar) else ""
    if text in known or (isinstance(value, Scalar) and value.data is BROKEN):
        return text if text in known else BROKEN
    noun = f"an installed {param.kind}" if param.type == "plugin" else "one of its choices"
    hint = did_you_mean(text, known, "installed" if param.type == "plugin" else "choices")
    hint += "  (see explore-bt plugins)" if param.type == "plugin" else ""
    faults.add(value.place, f"{param.name}: {written(value)} is not {noun}", hint)
    return BROKEN
