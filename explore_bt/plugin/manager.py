"""Starting the host: built-ins, installed plugins, then the file beside the mission."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from importlib import import_module
from importlib.metadata import EntryPoint, entry_points
from pathlib import Path

from explore_bt.errors import PluginError
from explore_bt.plugin.hooks import classes_of
from explore_bt.plugin.inline import INLINE_FILE, load_inline
from explore_bt.plugin.reasons import reason_of
from explore_bt.plugin.registry import BrokenPlugin, Registry
from explore_bt.version import __version__

__all__ = ["GROUP", "Host", "load_plugins"]

GROUP = "explore_bt"
"""The entry point group in which distributions name their plugin modules."""

_OWN = "explore-bt"
# by name, as entry points are: the host stands below what its built-ins are made of
_BUILTIN = "explore_bt.builtin"


@dataclass(frozen=True, slots=True)
class Host:
    """The plugins of one process: what is there, and what was left out."""

    registry: Registry

    @property
    def broken(self) -> tuple[BrokenPlugin, ...]:
        """Installed plugins that could not be loaded."""
        return self.registry.broken


def load_plugins(inline_dir: Path | None = None) -> Host:
    """Load every plugin once; call it at start-up, no hook runs later.

    Args:
        inline_dir: a mission's folder, whose ``explore_bt_inline.py`` is a plugin too.

    Returns:
        The host. A broken installed plugin is named in ``broken`` and left out.

    Raises:
        PluginError: the file beside the mission is broken; the message names its line.
    """
    registry = Registry()
    builtin = import_module(_BUILTIN)
    registry.add_all(classes_of(builtin, _OWN), _OWN, __version__)
    load_entry_points(registry, entry_points(group=GROUP))
    if inline_dir is not None and (inline_dir / INLINE_FILE).is_file():
        load_inline(registry, inline_dir / INLINE_FILE)
    return Host(registry)


def load_entry_points(registry: Registry, found: Iterable[EntryPoint]) -> None:
    """Load entry points one by one, explore-bt's own first; set aside what cannot be loaded."""
    for entry_point in sorted(
        found, key=lambda each: (_distribution(each) != _OWN, _distribution(each), each.name)
    ):
        _load_one(registry, entry_point)


def _load_one(registry: Registry, entry_point: EntryPoint) -> None:
    distribution = entry_point.dist
    origin = f"{_distribution(entry_point) or 'unknown'} ({entry_point.value})"
    try:
        module = entry_point.load()
        registry.add_all(
            classes_of(module, entry_point.name), origin, distribution.version if distribution else ""
        )
    except PluginError as refused:
        reason = str(refused).removeprefix(f"{origin}: ")
    except (Exception, SystemExit) as raised:  # whatever a plugin does at import, the host lives
        reason = reason_of(raised, distribution)
    else:
        return
    registry.set_aside(BrokenPlugin(entry_point.name, origin, reason))


def _distribution(entry_point: EntryPoint) -> str:
    return entry_point.dist.name if entry_point.dist else ""
