"""Built-in controllers: ``pursuit``."""

from __future__ import annotations

from explore_bt import hookimpl
from explore_bt_controllers.pursuit import Pursuit

__all__ = ["Pursuit", "explore_bt_register"]


@hookimpl
def explore_bt_register() -> list[type]:
    """The controllers of this family."""
    return [Pursuit]
