"""What can be set on a plugin: the options of its class, or the ports of a leaf."""

from __future__ import annotations

import types
import typing
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pydantic.fields import FieldInfo

from explore_bt.interfaces import PluginOptions
from explore_bt.tree import REQUIRED, Key, Leaf
from explore_bt.units import ANGLE, Dimension, PoseTriple

__all__ = ["Option", "options_of"]

_NAMES: dict[Any, str] = {
    typing.get_args(PoseTriple)[0]: "pose [x, y, heading]",
    Path: "file",
    type(None): "none",
}

_DEG_PER_RAD = 1.0 / ANGLE.factors[1][1]


@dataclass(frozen=True, slots=True)
class Option:
    """One option or port, in words: ``default`` carries its unit, and is ``required`` without one."""

    name: str
    type: str
    default: str
    doc: str


def options_of(cls: type) -> list[Option]:
    """Options in the order they are declared; a leaf's inputs, then its outputs."""
    if issubclass(cls, Leaf):
        return [*_inputs(cls), *_outputs(cls)]
    options: type[PluginOptions] = getattr(cls, "Options", PluginOptions)
    return [_of_field(name, field) for name, field in options.model_fields.items()]


def _inputs(leaf: type[Leaf]) -> Iterator[Option]:
    for name, port in leaf.inputs.items():
        dimension = _dimension(typing.get_args(port.type))
        yield Option(name, _type(port.type, dimension), _default(port.default, dimension), port.doc)


def _outputs(leaf: type[Leaf]) -> Iterator[Option]:
    for name, port in leaf.outputs.items():
        yield Option(name, f"writes {_type(port.type, None)}", _default(port.default, None), port.doc)


def _of_field(name: str, field: FieldInfo) -> Option:
    # pydantic takes Annotated apart; in a union (Length | None) it stays inside the annotation
    dimension = _dimension(field.metadata)
    default = REQUIRED if field.is_required() else field.get_default(call_default_factory=True)
    shown = _default(default, dimension or _dimension_inside(field.annotation))
    return Option(name, _type(field.annotation, dimension), shown, field.description or "")


def _dimension(metadata: Sequence[object]) -> Dimension | None:
    return next((each for each in metadata if isinstance(each, Dimension)), None)


def _dimension_inside(union: object) -> Dimension | None:
    found = (_dimension(typing.get_args(each)) for each in typing.get_args(union))
    return next((each for each in found if each), None)


def _type(annotation: Any, dimension: Dimension | None) -> str:  # a type form; there is no type for those
    origin, inside = typing.get_origin(annotation), typing.get_args(annotation)
    if origin is typing.Annotated:
        return _type(inside[0], _dimension(inside))
    if dimension is not None:
        return dimension.name
    if annotation in _NAMES:
        return _NAMES[annotation]
    if origin is typing.Literal:
        return " | ".join(str(value) for value in inside)
    if origin in (typing.Union, types.UnionType):
        return " or ".join(_type(each, None) for each in inside)
    return getattr(annotation, "__name__", str(annotation))


def _default(value: object, dimension: Dimension | None) -> str:
    if value is REQUIRED:
        return "required"
    if isinstance(value, Key):
        return f"${value.name}"
    if value is None:
        return "none"
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, float) and dimension is not None:
        return _quantity(value, dimension)
    return f"{value:g}" if isinstance(value, float) else str(value)


def _quantity(value: float, dimension: Dimension) -> str:
    """In degrees where people write degrees, else SI."""
    if dimension.si.startswith("rad"):
        return f"{value * _DEG_PER_RAD:.4g} {dimension.si.replace('rad', 'deg')}"
    return f"{value:g} {dimension.si}"
