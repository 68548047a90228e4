"""Calling one plugin's hook, and refusing hooks that nobody would ever call."""

from __future__ import annotations

import difflib
from collections.abc import Iterable
from types import ModuleType

import pluggy

from explore_bt.errors import PluginError
from explore_bt.plugin.spec import ExploreBtSpec

__all__ = ["classes_of"]

_HOOK = "explore_bt_register"


def classes_of(plugin: ModuleType | object, name: str) -> list[type]:
    """What a plugin's hook returns; each plugin has a manager of its own, so that none hurts another.

    Args:
        plugin: a module, or an object with the hook as a method.
        name: how to call it in messages.

    Raises:
        PluginError: no hook, a misspelt one, one with arguments we do not give, or a hook that returns
            something other than classes. What the hook itself raises passes through.
    """
    manager = pluggy.PluginManager("explore_bt")
    manager.add_hookspecs(ExploreBtSpec)
    try:
        manager.register(plugin, name=name)
        manager.check_pending()
    except pluggy.PluginValidationError as refused:
        raise PluginError(_validation(refused)) from None
    hooks = [hook.name for hook in manager.get_hookcallers(plugin) or []]
    if _HOOK not in hooks:
        raise PluginError(f"registers nothing: define {_HOOK}() and mark it with @explore_bt.hookimpl")
    (returned,) = manager.hook.explore_bt_register() or [None]
    if not isinstance(returned, Iterable) or isinstance(returned, str):
        raise PluginError(f"{_HOOK} returned {returned!r}; expected a list of classes")
    return list(returned)


def _validation(refused: pluggy.PluginValidationError) -> str:
    text = str(refused).splitlines()
    unknown = next((line.split("'")[1] for line in text if line.startswith("unknown hook")), None)
    if unknown is None:
        return text[-1] if len(text) == 1 else " ".join(line.strip() for line in text if line.strip())
    close = difflib.get_close_matches(unknown, [_HOOK], n=1)
    return f"there is no hook {unknown}; " + (
        f"did you mean {close[0]}?" if close else f"the hook is {_HOOK}"
    )
