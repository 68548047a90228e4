"""What the mission loader needs to know of the plugin host."""

from __future__ import annotations

from typing import Protocol

__all__ = ["PluginCatalog"]


class PluginCatalog(Protocol):
    """Classes by kind and name; ``explore_bt.plugin.Registry`` is one."""

    def get(self, kind: str, name: str) -> type:
        """The class; raises ``PluginError`` where there is none."""

    def names(self, kind: str) -> tuple[str, ...]:
        """All names of a kind."""
