"""Drivers that come with explore-bt."""

from __future__ import annotations

from collections.abc import Sequence

from explore_bt import hookimpl
from explore_bt_drivers.replay import Replay, ReplayOptions
from explore_bt_drivers.sim2d import Sim2d, Sim2dOptions

__all__ = ["Replay", "ReplayOptions", "Sim2d", "Sim2dOptions"]


@hookimpl
def explore_bt_register() -> Sequence[type]:
    """The drivers of this package."""
    return [Sim2d, Replay]
