"""Modifiers of a node: name, doc, timeout, retry, on_failure, if."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Annotated

from pydantic import Field, TypeAdapter

from explore_bt.mission.bounds import Asked
from explore_bt.mission.checking import check_value
from explore_bt.mission.document import Entry, Scalar, Value
from explore_bt.mission.faults import Faults
from explore_bt.mission.nodes import Condition, Modifiers, NodeSpec
from explore_bt.mission.reading import expect_text
from explore_bt.mission.references import NAME, resolve
from explore_bt.mission.spot import ReadNode, Spot
from explore_bt.units import DURATION, Duration

__all__ = ["ModifierReader"]

_IN_PATHS = "/@"


class ModifierReader:
    """Reads modifiers; nodes in them are read by ``read_node``."""

    def __init__(self, read_node: ReadNode, faults: Faults) -> None:
        self._read_node = read_node
        self._faults = faults
        self._duration: TypeAdapter[float] = TypeAdapter(Annotated[Duration, Field(gt=0)])
        self._retries: TypeAdapter[int] = TypeAdapter(Annotated[int, Field(ge=1)])

    def name(self, modifiers: Mapping[str, Entry]) -> str:
        """The node's own name, empty if it has none."""
        entry = modifiers.get("name")
        if entry is None:
            return ""
        name = expect_text(entry.value, "name", self._faults) or ""
        if any(character in name for character in _IN_PATHS):
            self._faults.add(entry.value.place, f'the name "{name}" contains / or @', "paths need them")
        return name.strip()

    def doc(self, modifiers: Mapping[str, Entry]) -> str:
        """The node's comment, empty if it has none."""
        entry = modifiers.get("doc")
        return (expect_text(entry.value, "doc", self._faults) or "") if entry else ""

    def read(self, modifiers: Mapping[str, Entry], spot: Spot) -> Modifiers:
        """What is to be wrapped around the node at ``spot``."""
        timeout = self._number(modifiers, "timeout", self._duration, Asked(DURATION, gt=0.0), spot)
        retry = self._number(modifiers, "retry", self._retries, Asked(), spot)
        handler, condition = modifiers.get("on_failure"), modifiers.get("if")
        return Modifiers(
            timeout,
            None if retry is None else int(retry),
            self._attached(handler.value, "on_failure", spot) if handler else None,
            self._condition(condition.value, spot) if condition else None,
        )

    def _number(
        self,
        modifiers: Mapping[str, Entry],
        key: str,
        adapter: TypeAdapter[float] | TypeAdapter[int],
        asked: Asked,
        spot: Spot,
    ) -> float | None:
        entry = modifiers.get(key)
        if entry is None:
            return None
        value = resolve(entry.value, spot.scope, self._faults)
        if isinstance(value, Scalar) and value.data is None and value.text.startswith("$"):
            return None
        found = check_value(
            lambda text: adapter.validate_json(text, strict=True), value, key, asked, self._faults
        )
        return found if isinstance(found, int | float) else None

    def _attached(self, value: Value, key: str, spot: Spot) -> NodeSpec | None:
        return self._read_node(value, replace(spot, path=f"{spot.path}@{key}"), set())

    def _condition(self, value: Value, spot: Spot) -> NodeSpec | Condition | None:
        if not isinstance(value, Scalar) or not isinstance(value.data, str) or "$" not in value.data:
            return self._attached(value, "if", spot)
        text = value.data.strip()
        negated = text.startswith("not ")
        reference = text.removeprefix("not ").strip()
        if reference.startswith("$") and NAME.fullmatch(reference[1:]):
            return Condition(reference[1:], negated, value.place)
        hint = "write if: $entry, if: not $entry, or a node"
        self._faults.add(value.place, f"if: {text} is not a condition", hint)
        return None
