"""Control nodes: children and settings."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Annotated, Literal

from pydantic import Field, TypeAdapter

from explore_bt.mission.bounds import Asked
from explore_bt.mission.checking import check_value
from explore_bt.mission.document import Entries, Entry, Items, Scalar, Value
from explore_bt.mission.faults import Faults
from explore_bt.mission.nodes import NodeSpec
from explore_bt.mission.reading import check_keys, expect_items, written
from explore_bt.mission.references import BROKEN, resolve
from explore_bt.mission.spot import ReadNode, Spot
from explore_bt.mission.words import did_you_mean

__all__ = ["ControlReader"]

_LISTS = ("sequence", "fallback", "reactive_sequence", "reactive_fallback")
_Count = Annotated[int, Field(ge=1)]


class ControlReader:
    """Reads control nodes; what is below them is read by ``read_node``."""

    def __init__(
        self,
        trees: Mapping[str, Entry],
        is_whole: bool,
        used: set[str],
        read_node: ReadNode,
        faults: Faults,
    ) -> None:
        self._trees = trees
        self._is_whole = is_whole
        self._used = used
        self._read_node = read_node
        self._faults = faults
        self._times: TypeAdapter[object] = TypeAdapter(Literal["forever"] | _Count)
        self._needed: TypeAdapter[object] = TypeAdapter(Literal["all"] | _Count)
        self._failures: TypeAdapter[object] = TypeAdapter(_Count)

    def read(self, entry: Entry, name: str, path: str, spot: Spot) -> NodeSpec | None:
        """A control node with its children; None where it holds none."""
        settings: dict[str, object] = {}
        if entry.key == "subtree":
            children = self._subtree(entry, spot)
            settings = {"tree": entry.value.text if isinstance(entry.value, Scalar) else ""}
        elif entry.key in _LISTS:
            children = self._children(entry.value, entry.key, spot, entry)
        elif entry.key == "parallel":
            children, settings = self._parallel(entry, spot)
        elif entry.key == "repeat":
            children, settings = self._repeat(entry, spot)
        else:
            children = self._one(entry.value, spot)
        if not children:
            return None
        return NodeSpec(entry.key, name, path, entry.place, settings=settings, children=children)

    def _one(self, value: Value, spot: Spot) -> tuple[NodeSpec, ...]:
        node = self._read_node(value, spot, set())
        return (node,) if node else ()

    def _children(self, value: Value | None, what: str, spot: Spot, owner: Entry) -> tuple[NodeSpec, ...]:
        found = expect_items(value, what, f"{what}: [...], one node an item", self._faults)
        if not found and (value is None or isinstance(value, Items) or getattr(value, "data", "") is None):
            self._faults.add(owner.place, f"{owner.key} has no children", "list its nodes below it (- ...)")
        taken: set[str] = set()
        nodes = [self._read_node(each, spot, taken) for each in found]
        return tuple(node for node in nodes if node is not None)

    def _parallel(self, entry: Entry, spot: Spot) -> tuple[tuple[NodeSpec, ...], dict[str, object]]:
        if not isinstance(entry.value, Entries):
            return self._children(entry.value, "parallel", spot, entry), {"success": "all", "failure": 1}
        entries = entry.value
        check_keys(entries, ("success", "failure", "children"), "parallel", self._faults)
        children = self._children(entries.get("children"), "children", spot, entry)
        settings = {
            "success": self._setting(entries, "success", "all", self._needed, spot),
            "failure": self._setting(entries, "failure", 1, self._failures, spot),
        }
        listed = entries.get("children")
        count = len(listed.values) if isinstance(listed, Items) else 0
        for key, wanted in settings.items():
            if isinstance(wanted, int) and wanted > count > 0:
                place = entries.by_key[key].value.place
                self._faults.add(place, f"{key}: {wanted} is more than its {count} children", f"1 to {count}")
        return children, settings

    def _repeat(self, entry: Entry, spot: Spot) -> tuple[tuple[NodeSpec, ...], dict[str, object]]:
        entries, example = entry.value, "write repeat: {times: 3, child: ...}"
        if not isinstance(entries, Entries):
            self._faults.add(entries.place, f"repeat: {written(entries)} is not times and child", example)
            return (), {}
        check_keys(entries, ("times", "child"), "repeat", self._faults)
        child = entries.get("child")
        for key in ("times", "child"):
            if key not in entries.by_key:
                self._faults.add(entry.place, f"repeat has no {key}", example)
        times = self._setting(entries, "times", "forever", self._times, spot)
        return (self._one(child, spot) if child else ()), {"times": times}

    def _setting(
        self, entries: Entries, key: str, default: object, adapter: TypeAdapter[object], spot: Spot
    ) -> object:
        if key not in entries.by_key:
            return default
        value = resolve(entries.by_key[key].value, spot.scope, self._faults)
        found = check_value(
            lambda text: adapter.validate_json(text, strict=True), value, key, Asked(), self._faults
        )
        return default if found is BROKEN else found

    def _subtree(self, entry: Entry, spot: Spot) -> tuple[NodeSpec, ...]:
        value = entry.value
        if not isinstance(value, Scalar) or not isinstance(value.data, str):
            hint = "write subtree: NAME, a name in trees:"
            self._faults.add(value.place, f"subtree: {written(value)} is not the name of a tree", hint)
            return ()
        name = value.data
        if name not in self._trees:
            if self._is_whole:
                hint = did_you_mean(name, self._trees, "trees")
                self._faults.add(value.place, f'there is no tree "{name}"', hint)
            return ()
        if name in spot.trees:
            way = " -> ".join((*spot.trees[spot.trees.index(name) :], name))
            self._faults.add(value.place, f"trees hold one another: {way}", "use repeat: for a loop")
            return ()
        self._used.add(name)
        return self._one(self._trees[name].value, replace(spot, trees=(*spot.trees, name)))
