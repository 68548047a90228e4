"""Built-in controllers: ``pursuit``, ``mppi``."""

from __future__ import annotations

from explore_bt import hookimpl
from explore_bt_controllers.mppi import Mppi
from explore_bt_controllers.pursuit import Pursuit

__all__ = ["Mppi", "Pursuit", "explore_bt_register"]


@hookimpl
def explore_bt_register() -> list[type]:
    """The controllers of this family."""
    return [Pursuit, Mppi]
