"""Leaves: ports against what the leaf's class declares."""

from __future__ import annotations

from typing import Any

from pydantic import TypeAdapter

from explore_bt.mission.bounds import asked_by_port
from explore_bt.mission.catalog import PluginCatalog
from explore_bt.mission.checking import check_value, find_key
from explore_bt.mission.document import Entries, Entry, Scalar, Value
from explore_bt.mission.faults import Faults
from explore_bt.mission.nodes import CONTROL_NODES, NodeSpec
from explore_bt.mission.reading import written
from explore_bt.mission.references import BROKEN, is_broken, resolve
from explore_bt.mission.spot import Spot
from explore_bt.mission.words import did_you_mean, show
from explore_bt.tree import REQUIRED, Input, Key, Leaf, Output

__all__ = ["LeafReader"]

Port = Input[Any] | Output[Any]


class LeafReader:
    """Reads leaves; ``broken`` once a port had to be left out."""

    def __init__(self, catalog: PluginCatalog, faults: Faults) -> None:
        self._catalog = catalog
        self._faults = faults
        self._adapters: dict[Input[Any], TypeAdapter[Any]] = {}
        self.broken = False

    def ports(self, key: str) -> dict[str, Port]:
        """The ports of a leaf; none for a control node."""
        if key in CONTROL_NODES:
            return {}
        cls = self._leaf(key)
        return {**cls.inputs, **cls.outputs}

    def _leaf(self, key: str) -> type[Leaf]:
        cls = self._catalog.get("behaviour", key)
        assert issubclass(cls, Leaf)  # the catalog's contract for this kind
        return cls

    def read(self, entry: Entry, name: str, path: str, spot: Spot) -> NodeSpec:
        """A leaf with its bindings; only ports that the mission gives are bound."""
        ports = self.ports(entry.key)
        bindings: dict[str, object] = {}
        places = {}
        for given in self._given(entry, ports):
            if given.key not in ports:
                hint = did_you_mean(given.key, ports, "ports")
                self._faults.add(given.place, f'{entry.key} has no port "{given.key}"', hint)
                continue
            value = resolve(given.value, spot.scope, self._faults)
            bound = self._bind(ports[given.key], given.key, value)
            if bound is not None:
                bindings[given.key], places[given.key] = bound, value.place
        missing = [p for p, port in ports.items() if port.default is REQUIRED and p not in bindings]
        for port in missing:
            self._faults.add(
                entry.place, f'{entry.key} needs the port "{port}"', f"{port}: {ports[port].doc}"
            )
        self.broken |= any(bound is BROKEN for bound in bindings.values())
        return NodeSpec(
            entry.key, name, path, entry.place, leaf=self._leaf(entry.key), bindings=bindings, places=places
        )

    def _given(self, entry: Entry, ports: dict[str, Port]) -> tuple[Entry, ...]:
        value = entry.value
        if isinstance(value, Entries):
            return value.entries
        if not (isinstance(value, Scalar) and value.data is None):
            port = next(iter(ports), "port")
            message = f"{entry.key}: {written(value)} is not a mapping of ports"
            self._faults.add(value.place, message, f"write {entry.key}: {{{port}: {written(value)}}}")
        return ()

    def _bind(self, port: Port, name: str, value: Value) -> object:
        """A ``Key``, a constant, ``BROKEN``, or None for a parameter that is not given."""
        if is_broken(value):
            return BROKEN
        if isinstance(value, Scalar) and isinstance(value.data, Key):
            return value.data
        if isinstance(value, Scalar) and value.data is None and value.text.startswith("$"):
            return None
        if isinstance(port, Input) and port.takes_constants and find_key(value) is None:
            return self._constant(port, name, value)
        return self._refuse(port, name, value)

    def _constant(self, port: Input[Any], name: str, value: Value) -> object:
        if port not in self._adapters:
            self._adapters[port] = port.adapter
        adapter, context = self._adapters[port], {"base_dir": value.place.source.folder}
        return check_value(
            lambda text: adapter.validate_json(text, strict=True, context=context),
            value,
            name,
            asked_by_port(port),
            self._faults,
        )

    def _refuse(self, port: Port, name: str, value: Value) -> object:
        default = port.default
        example = default.name if isinstance(default, Key) else name
        found = written(value)
        if isinstance(value, Entries) and len(value.entries) == 1:
            example = value.entries[0].key
            found = f"{{{example}}}"
        if isinstance(value, Scalar) and isinstance(value.data, str) and value.data.isidentifier():
            example = value.data
        inside = find_key(value)
        if isinstance(port, Output):
            message = f"{name}: {found} is not a blackboard entry to write to"
        elif inside is not None:
            message = f"{name}: {show(inside.data)} stands inside {found}"
        else:
            message = f"{name}: {found} is not a blackboard entry"
        self._faults.add(value.place, message, f"write ${example}")
        return BROKEN
