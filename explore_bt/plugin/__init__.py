"""The plugin host: one hook, a registry of classes, and the loading of what is installed.

``explore_bt`` itself imports this package for ``hookimpl``, so that the registry and the host, which
bring the contracts and numpy with them, are imported on first use only.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

from explore_bt.plugin.spec import hookimpl

if TYPE_CHECKING:
    from explore_bt.plugin.extras import require
    from explore_bt.plugin.inline import INLINE_FILE
    from explore_bt.plugin.manager import Host, load_plugins
    from explore_bt.plugin.registry import KINDS, BrokenPlugin, Entry, Registry

__all__ = [
    "INLINE_FILE",
    "KINDS",
    "BrokenPlugin",
    "Entry",
    "Host",
    "Registry",
    "hookimpl",
    "load_plugins",
    "require",
]

_HOME = {
    "require": "extras",
    "INLINE_FILE": "inline",
    "Host": "manager",
    "load_plugins": "manager",
    "KINDS": "registry",
    "BrokenPlugin": "registry",
    "Entry": "registry",
    "Registry": "registry",
}


def __getattr__(name: str) -> object:
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_HOME[name]}"), name)
