"""``TreeNodesModel``: what an editor of trees has to know about our leaves."""

from __future__ import annotations

import contextlib
import types
import typing
from collections.abc import Iterable
from typing import Any
from xml.etree.ElementTree import Element, SubElement

from explore_bt.mission.bounds import dimension_of
from explore_bt.mission.btcpp.attributes import attribute_text
from explore_bt.mission.btcpp.vocabulary import ENTRY_HOLDS
from explore_bt.tree import REQUIRED, Input, Leaf, Output

__all__ = ["node_models"]

_PLAIN = {bool: "bool", int: "int", float: "double", str: "std::string"}


def node_models(leaves: Iterable[type[Leaf]]) -> Element:
    """The element with one model a leaf, and one for the condition that stands for ``if: $entry``."""
    models = Element("TreeNodesModel")
    for leaf in sorted(leaves, key=lambda each: each.type_key):
        model = SubElement(models, "Action", ID=leaf.type_key)
        for name, port in leaf.inputs.items():
            _port(model, "input_port", name, port)
        for name, output in leaf.outputs.items():
            _port(model, "output_port", name, output)
    condition = SubElement(models, "Condition", ID=ENTRY_HOLDS)
    entry = SubElement(condition, "input_port", name="entry", type="AnyTypeAllowed")
    entry.text = "the entry that must be written and be neither None, false, zero nor empty"
    return models


def _port(model: Element, direction: str, name: str, port: Input[Any] | Output[Any]) -> None:
    element = SubElement(model, direction, name=name, type=_type(port.type))
    if port.default is not REQUIRED:
        with contextlib.suppress(ValueError):  # one that no attribute can hold is not told
            element.set("default", attribute_text(port.default))
    dimension = dimension_of(port.type)
    element.text = f"{port.doc} ({dimension.si})" if dimension else port.doc


def _type(annotation: Any) -> str:  # a type form; there is no type for those
    origin, inside = typing.get_origin(annotation), typing.get_args(annotation)
    if origin is typing.Annotated:
        return _type(inside[0])
    if origin is typing.Literal:
        return _one({_PLAIN.get(type(value), "std::string") for value in inside})
    if origin in (typing.Union, types.UnionType):
        return _one({_type(each) for each in inside if each is not type(None)})
    return _PLAIN.get(annotation) or str(getattr(annotation, "__name__", "AnyTypeAllowed"))


def _one(names: set[str]) -> str:
    return names.pop() if len(names) == 1 else "std::string"
