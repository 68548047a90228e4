"""``$params.x``, ``$env.X``, ``$robot.x`` and ``$entry``."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, replace

from explore_bt.mission.document import Entries, Entry, Items, Scalar, Value
from explore_bt.mission.faults import Faults
from explore_bt.mission.scalars import plain_scalar
from explore_bt.mission.words import did_you_mean
from explore_bt.tree import Key

__all__ = ["BROKEN", "NAME", "Scope", "is_broken", "plain_data", "resolve"]

NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")
_CONSTANT = re.compile(r"\$(params|env|robot)\.(\S+)")


class _Broken:
    """Stands for a value whose fault is already noted, so that nothing more is said about it."""


BROKEN = _Broken()


@dataclass(frozen=True, slots=True)
class Scope:
    """What constants mean in one place: parameters, environment, and the robot whose tree it is."""

    params: Mapping[str, object]
    environ: Mapping[str, str]
    robot: str = ""


def resolve(value: Value, scope: Scope, faults: Faults) -> Value:
    """``value`` with constants put in and ``$entry`` turned into ``Key("entry")``."""
    if isinstance(value, Items):
        return replace(value, values=tuple(resolve(each, scope, faults) for each in value.values))
    if isinstance(value, Entries):
        entries = (Entry(e.key, e.place, resolve(e.value, scope, faults)) for e in value)
        return Entries(tuple(entries), value.place, value.size)
    if not isinstance(value.data, str) or "$" not in value.data:
        return value
    return replace(value, data=_meaning(value, value.data, scope, faults))


def _meaning(value: Scalar, text: str, scope: Scope, faults: Faults) -> object:
    constant = _CONSTANT.fullmatch(text)
    if constant:
        return _constant(value, constant[1], constant[2], scope, faults)
    if text.startswith("$") and NAME.fullmatch(text[1:]):
        return Key(text[1:])
    braces = re.search(r"\$\{([^}]*)\}?", text)
    if braces:
        faults.add(value.place, f"{text} is not a reference", f"write ${braces[1]}")
    elif text.startswith("$"):
        faults.add(
            value.place, f"{text} is not a reference", "write $entry, $params.name, $env.NAME or $robot.name"
        )
    else:
        return text
    return BROKEN


def _constant(value: Scalar, family: str, name: str, scope: Scope, faults: Faults) -> object:
    if family == "params":
        if name in scope.params:
            return scope.params[name]
        hint = did_you_mean(name, scope.params, "parameters")
        faults.add(value.place, f'there is no parameter "{name}"', hint)
    elif family == "env":
        if name in scope.environ:
            return plain_scalar(scope.environ[name])
        faults.add(value.place, f"the environment variable {name} is not set", f"export {name}=...")
    elif name == "name" and scope.robot:
        return scope.robot
    elif name == "name":
        faults.add(value.place, "$robot.name has no meaning here", "use it under robots: or in a tree")
    else:
        faults.add(value.place, f'a robot has no constant "{name}"', "known: $robot.name")
    return BROKEN


def is_broken(value: Value) -> bool:
    """Whether a fault in ``value`` is already noted."""
    if isinstance(value, Scalar):
        return value.data is BROKEN
    parts = value.values if isinstance(value, Items) else tuple(entry.value for entry in value)
    return any(is_broken(part) for part in parts)


def plain_data(value: Value) -> object:
    """``value`` as plain Python data."""
    if isinstance(value, Items):
        return [plain_data(each) for each in value.values]
    if isinstance(value, Entries):
        return {entry.key: plain_data(entry.value) for entry in value}
    return value.data
