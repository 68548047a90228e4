"""Built-in planners: ``skeleton`` and ``grid_astar``."""

from __future__ import annotations

from explore_bt import hookimpl
from explore_bt_planners.grid_astar import GridAstar
from explore_bt_planners.skeleton import Skeleton

__all__ = ["GridAstar", "Skeleton", "explore_bt_register"]


@hookimpl
def explore_bt_register() -> list[type]:
    """The planners of this family."""
    return [Skeleton, GridAstar]
