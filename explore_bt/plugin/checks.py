"""What a class must have before it may be registered."""

from __future__ import annotations

import inspect
import re

from explore_bt.errors import PluginError
from explore_bt.interfaces import (
    API_VERSION,
    Allocator,
    Bridge,
    Controller,
    Driver,
    Exporter,
    Planner,
    PluginOptions,
    Sink,
    Slam,
    Team,
)
from explore_bt.tree import Leaf

__all__ = ["CONTRACTS", "KINDS", "check_class", "kind_of", "name_of"]

CONTRACTS: dict[str, type] = {
    contract.kind: contract
    for contract in (Driver, Slam, Planner, Controller, Team, Allocator, Leaf, Sink, Exporter, Bridge)
}
"""Kind -> the class to derive from."""

KINDS = tuple(CONTRACTS)
"""Every kind a plugin can be of, in the order they are listed."""

_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]*")


def kind_of(cls: type) -> str | None:
    """The kind it says it is of; None if it does not say."""
    value = getattr(cls, "kind", None)
    return value if isinstance(value, str) else None


def name_of(cls: type) -> str | None:
    """How missions call the class: ``name``, for leaves ``type_key``; None if it does not say."""
    attribute = "type_key" if kind_of(cls) == Leaf.kind else "name"
    # a Leaf inherits a property "name" from py_trees; only text is a name
    value = getattr(cls, attribute, None)
    return value if isinstance(value, str) else None


def check_class(cls: object, origin: str) -> None:
    """Refuse what cannot be a plugin class.

    Raises:
        PluginError: naming the origin, the class, what is wrong and what was expected.
    """
    fault = _fault(cls)
    if fault:
        raise PluginError(f"{origin}: {fault}")


def _fault(cls: object) -> str | None:
    if not isinstance(cls, type):
        return f"{cls!r} is not a class; explore_bt_register returns classes, not objects"
    who = cls.__qualname__
    kind = kind_of(cls)
    if kind not in CONTRACTS:
        found = f"{who} has no kind" if kind is None else f"{who} is of unknown kind {kind!r}"
        return f"{found}; derive it from one of {', '.join(_public(each) for each in CONTRACTS.values())}"
    contract = CONTRACTS[kind]
    if not issubclass(cls, contract):
        return f'{who} says kind = "{kind}" but does not derive from {_public(contract)}'
    return _fault_of_plugin(cls, who, contract)


def _fault_of_plugin(cls: type, who: str, contract: type) -> str | None:
    abstract = sorted(getattr(cls, "__abstractmethods__", ()))
    if inspect.isabstract(cls) and abstract:
        return f"{who} lacks {', '.join(abstract)}: {_public(contract)} asks for every one of them"
    attribute = "type_key" if contract is Leaf else "name"
    name = name_of(cls)
    if not name:
        return f'{who} has no {attribute}; write {attribute} = "..." in the class'
    if not _NAME.fullmatch(name):
        return f'{who} is called "{name}"; a name is made of letters, digits and underscores'
    return _fault_of_version(cls, who) or _fault_of_options(cls, who)


def _fault_of_version(cls: type, who: str) -> str | None:
    version = getattr(cls, "api_version", None)
    if version is None:
        return f"{who} has no api_version; write api_version = {API_VERSION} in the class"
    if version != API_VERSION:
        return (
            f"{who} was written for version {version} of the plugin contracts, this explore-bt has version "
            f"{API_VERSION}; install versions that fit together"
        )
    return None


def _fault_of_options(cls: type, who: str) -> str | None:
    options = getattr(cls, "Options", PluginOptions)
    if not (isinstance(options, type) and issubclass(options, PluginOptions)):
        return f"{who}.Options does not derive from explore_bt.interfaces.PluginOptions"
    return None


def _public(contract: type) -> str:
    package = "explore_bt.tree" if contract is Leaf else "explore_bt.interfaces"
    return f"{package}.{contract.__name__}"
