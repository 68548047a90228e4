"""Nodes of behaviour trees: YAML values to checked ``NodeSpec``s."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace

from explore_bt.mission.catalog import PluginCatalog
from explore_bt.mission.control_reader import ControlReader
from explore_bt.mission.document import Entries, Entry, Items, Scalar, Value
from explore_bt.mission.faults import Faults
from explore_bt.mission.leaf_reader import LeafReader
from explore_bt.mission.modifier_reader import ModifierReader
from explore_bt.mission.nodes import CONTROL_NODES, MODIFIERS, NodeSpec
from explore_bt.mission.reading import written
from explore_bt.mission.references import Scope, is_broken, resolve
from explore_bt.mission.spot import Spot
from explore_bt.mission.words import did_you_mean, listed

__all__ = ["TreeReader"]

_DEEPEST = 80
_MOST_NODES = 2000


class TreeReader:
    """Reads trees of one mission; notes every fault.

    Args:
        is_whole: False where an included file could not be read: the trees in it are then not missed.

    Attributes:
        complete: False once a node had to be left out, so that what it would have written is not known.
    """

    def __init__(
        self, trees: Mapping[str, Entry], is_whole: bool, catalog: PluginCatalog, faults: Faults
    ) -> None:
        self._trees = trees
        self._is_whole = is_whole
        self._catalog = catalog
        self._faults = faults
        self._leaves = LeafReader(catalog, faults)
        self._used: set[str] = set()
        self._control = ControlReader(trees, is_whole, self._used, self.read, faults)
        self._modifiers = ModifierReader(self.read, faults)
        self._count = 0
        self.complete = True

    def root(self, value: Value, scope: Scope) -> NodeSpec | None:
        """A robot's tree: the name of one in ``trees`` (or a parameter that holds it), or a node."""
        self._count, self.complete, self._leaves.broken = 0, True, False
        if isinstance(value, Scalar):
            value = resolve(value, scope, self._faults)
            if is_broken(value):
                return None
        if not isinstance(value, Scalar) or not isinstance(value.data, str):
            return self.read(value, Spot("", scope))
        if value.data not in self._trees:
            if self._is_whole:
                hint = did_you_mean(value.data, self._trees, "trees")
                self._faults.add(value.place, f'there is no tree "{value.data}"', hint)
            return None
        entry = self._trees[value.data]
        self._used.add(entry.key)
        return self.read(entry.value, Spot("", scope, (entry.key,)), default_name=entry.key)

    def read(
        self, value: Value, spot: Spot, taken: set[str] | None = None, default_name: str = ""
    ) -> NodeSpec | None:
        """One node with all below it; None if it has to be left out.

        Args:
            value: what stands there.
            spot: where it is to stand.
            taken: names of its siblings so far; its own is added.
            default_name: what it is called if it does not say.
        """
        node = self._read(value, spot, set() if taken is None else taken, default_name)
        if node is None or self._leaves.broken:
            self.complete = False
        return node

    def _read(self, value: Value, spot: Spot, taken: set[str], default_name: str) -> NodeSpec | None:
        self._count += 1
        if self._count > _MOST_NODES or spot.depth > _DEEPEST:
            limit = f"more than {_MOST_NODES} nodes" if self._count > _MOST_NODES else f"over {_DEEPEST} deep"
            self._faults.add(
                value.place, f"the tree is too large: {limit}", "check which subtree holds which"
            )
            return None
        entry, modifiers = self._parts(value)
        if entry is None:
            return None
        name = self._modifiers.name(modifiers) or default_name or self._default_name(entry)
        path = _unique(f"{spot.path}/{name}" if spot.path else name, taken)
        read: Callable[[Entry, str, str, Spot], NodeSpec | None]
        read = self._control.read if entry.key in CONTROL_NODES else self._leaves.read
        node = read(entry, name, path, spot.below(path))
        wrapped = self._modifiers.read(modifiers, spot.below(path))
        return node and replace(node, modifiers=wrapped, doc=self._modifiers.doc(modifiers))

    @staticmethod
    def _default_name(entry: Entry) -> str:
        value = entry.value
        is_subtree = entry.key == "subtree" and isinstance(value, Scalar) and isinstance(value.data, str)
        return value.text if is_subtree and isinstance(value, Scalar) else entry.key

    def _parts(self, value: Value) -> tuple[Entry | None, dict[str, Entry]]:
        """The type key with its value, and the modifiers beside it."""
        if isinstance(value, Scalar) and isinstance(value.data, str):
            nothing = Scalar(None, "", True, value.place)
            return self._known(Entry(value.data, value.place, nothing)), {}
        if not isinstance(value, Entries) or not value.entries:
            hint = (
                "put it below sequence:"
                if isinstance(value, Items)
                else "write a leaf's name, or TYPE: {...}"
            )
            self._faults.add(value.place, f"{written(value)} is not a node", hint)
            return None, {}
        modifiers = {entry.key: entry for entry in value if entry.key in MODIFIERS}
        others = [entry for entry in value if entry.key not in MODIFIERS]
        types = [entry for entry in others if self._is_type(entry.key)]
        if not others:
            self._faults.add(
                value.place, "a node needs one type key", "a control node or a leaf beside its modifiers"
            )
            return None, modifiers
        if not types:
            for entry in others:
                self._known(entry)
            return None, modifiers
        for entry in others:
            if entry is not types[0]:
                self._too_many(entry, types[0])
        return types[0], modifiers

    def _is_type(self, key: str) -> bool:
        return key in CONTROL_NODES or key in self._catalog.names("behaviour")

    def _known(self, entry: Entry) -> Entry | None:
        """``entry`` if its key is a type; else the fault is noted."""
        if self._is_type(entry.key):
            return entry
        names = [*CONTROL_NODES, *MODIFIERS, *self._catalog.names("behaviour")]
        hint = did_you_mean(entry.key, names)
        if not hint.endswith("?"):
            hint = listed(self._catalog.names("behaviour"), "leaves")
        if entry.key in self._trees:
            hint = f"write subtree: {entry.key}"
        self._faults.add(entry.place, f'there is no control node or leaf "{entry.key}"', hint)
        return None

    def _too_many(self, entry: Entry, first: Entry) -> None:
        if self._is_type(entry.key):
            message = f"a node has one type; this has {first.key} and {entry.key}"
            hint = "make each an item of a list (- ...)"
        elif entry.key in self._leaves.ports(first.key):
            message = f'the port "{entry.key}" stands beside {first.key}'
            hint = f"write {first.key}: {{{entry.key}: ...}}"
        else:
            message = f'"{entry.key}" beside {first.key} is no modifier'
            hint = did_you_mean(entry.key, MODIFIERS, "modifiers")
        self._faults.add(entry.place, message, hint)

    def check_unused(self, scope: Scope) -> None:
        """Read the trees that no robot uses too, so that their faults show."""
        for name, entry in self._trees.items():
            if name not in self._used:
                self._used.add(name)
                self._count = 0
                self.read(entry.value, Spot("", scope, (name,)), default_name=name)


def _unique(path: str, taken: set[str]) -> str:
    candidate, number = path, 1
    while candidate in taken:
        number += 1
        candidate = f"{path}#{number}"
    taken.add(candidate)
    return candidate
