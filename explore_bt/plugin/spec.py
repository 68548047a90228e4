"""The one hook through which every plugin, built in or not, comes to the host."""

from __future__ import annotations

from collections.abc import Sequence

import pluggy

__all__ = ["ExploreBtSpec", "hookimpl", "hookspec"]

hookspec = pluggy.HookspecMarker("explore_bt")
hookimpl = pluggy.HookimplMarker("explore_bt")


class ExploreBtSpec:
    """Hooks run once, when the host starts; none runs while a robot drives."""

    @hookspec
    def explore_bt_register(self) -> Sequence[type]:  # type: ignore[empty-body]  # a specification
        """Return plugin classes: subclasses of the contracts in ``explore_bt.interfaces``, or leaves."""
