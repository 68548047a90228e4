"""Who writes and who reads which blackboard entry, checked before anything runs."""

from __future__ import annotations

import types
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Any, Literal, Union, get_args, get_origin

from explore_bt.mission.bounds import dimension_of
from explore_bt.mission.faults import Faults
from explore_bt.mission.nodes import Condition, NodeSpec
from explore_bt.mission.source import Place
from explore_bt.mission.words import did_you_mean
from explore_bt.tree import REQUIRED, Input, Key, Output

__all__ = ["RUNTIME_KEYS", "check_wiring"]

RUNTIME_KEYS: tuple[str, ...] = ()
"""Entries that the runtime writes before the first tick."""


@dataclass(frozen=True, slots=True)
class _Use:
    """One end of a wire."""

    leaf: str
    port: str
    key: str
    type: Any
    place: Place
    optional: bool = False


def check_wiring(root: NodeSpec, faults: Faults) -> None:
    """Note entries that are read but never written, and writers and readers of different types.

    An input bound by its own default to an entry may go unwritten if it has an ``initial`` value; one that
    the mission binds may not, for that is how a misspelt entry looks. An entry counts as written if any
    leaf of the tree has an output bound to it, wherever it stands: a leaf that initialises shared memory
    and the leaves that add to it are told apart only at run time.
    """
    nodes = list(root.walk())
    writers: dict[str, list[_Use]] = {}
    for use in _uses(nodes, outputs=True):
        writers.setdefault(use.key, []).append(use)
    known = {*writers, *RUNTIME_KEYS}
    for use in _uses(nodes, outputs=False):
        if use.key not in known and not use.optional:
            message = f"{use.leaf} reads ${use.key} ({use.port}), which no leaf of the tree writes"
            faults.add(use.place, message, did_you_mean(use.key, known, "written"))
        for writer in writers.get(use.key, ()):
            _compare(writer, use, faults)
    for node in nodes:
        condition = node.modifiers.condition
        if isinstance(condition, Condition) and condition.key not in known:
            message = f"if: no leaf of the tree writes ${condition.key}"
            faults.add(condition.place, message, did_you_mean(condition.key, known, "written"))


def _uses(nodes: list[NodeSpec], outputs: bool) -> list[_Use]:
    uses = []
    for node in nodes:
        ports = _ports(node, outputs)
        for name, port in ports.items():
            bound = node.bindings.get(name, port.default)
            if isinstance(bound, Key):
                place = node.places.get(name, node.place)
                optional = name not in node.bindings and getattr(port, "initial", REQUIRED) is not REQUIRED
                uses.append(_Use(node.type, name, bound.name, port.type, place, optional))
    return uses


def _ports(node: NodeSpec, outputs: bool) -> Mapping[str, Input[Any] | Output[Any]]:
    if node.leaf is None:
        return {}
    return node.leaf.outputs if outputs else node.leaf.inputs


def _compare(writer: _Use, reader: _Use, faults: Faults) -> None:
    written, read = _classes(writer.type), _classes(reader.type)
    fits = any(_fits(one, other) for one in written for other in read)
    dimensions = (dimension_of(writer.type), dimension_of(reader.type))
    if fits and (None in dimensions or dimensions[0] == dimensions[1]):
        return
    message = (
        f"{reader.leaf} wants {_shown(reader.type)} in ${reader.key} ({reader.port}), "
        f"{writer.leaf} writes {_shown(writer.type)}"
    )
    faults.add(reader.place, message, f"{writer.leaf} stands at {writer.place}; give them different entries")


def _fits(written: type, read: type) -> bool:
    numbers = written is int and read is float
    return read is object or written is object or issubclass(written, read) or numbers


def _classes(type_: Any) -> tuple[type, ...]:
    """The run-time classes of a type form."""
    origin = get_origin(type_)
    if origin is Annotated:
        return _classes(get_args(type_)[0])
    if origin is Literal:
        return tuple({type(each) for each in get_args(type_)})
    if origin in (Union, types.UnionType):
        return tuple(cls for part in get_args(type_) for cls in _classes(part))
    found = origin or type_
    if found is None:
        return (type(None),)
    return (found,) if isinstance(found, type) else (object,)


def _shown(type_: Any) -> str:
    dimension = dimension_of(type_)
    if dimension is not None:
        return f"{'an' if dimension.name[0] in 'aeiou' else 'a'} {dimension.name}"
    return " or ".join(sorted({cls.__name__ for cls in _classes(type_)}))
