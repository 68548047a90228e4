"""The strategies that ship, and where they are."""

from __future__ import annotations

from pathlib import Path

from explore_bt.errors import UserError
from explore_bt.files import missions_folder
from explore_bt.interfaces import Allocator, Planner, RobotContext
from explore_bt.mission import NodeSpec, load_tree
from explore_bt.plugin import Registry

__all__ = ["STRATEGIES", "make_allocator", "make_planner", "read_strategy"]

_ROOMY_M = 1.5
STRATEGIES = ("complete", "paper", "nearest_frontier", "information_gain", "tour")
"""Names of the trees below ``missions/trees``."""


def read_strategy(strategy: str | Path, registry: Registry) -> NodeSpec:
    """The tree of a strategy, without the way home: ``explore_NAME`` if there is one, else ``NAME``.

    Args:
        strategy: a name of ``STRATEGIES``, or a file of trees with one called like the file.
        registry: the installed plugins.

    Raises:
        UserError: there is no such strategy; the message lists those that ship.
        MissionError: the file's faults, all of them.
    """
    path = Path(strategy)
    if path.suffix not in (".yaml", ".yml"):
        path = missions_folder() / "trees" / f"{strategy}.yaml"
    if not path.is_file():
        raise UserError(
            f"strategy: there is no {strategy}; expected one of {', '.join(STRATEGIES)}, or a file of trees"
        )
    return load_tree(path, (f"explore_{path.stem}", path.stem), registry)


def make_planner(registry: Registry, footprint_radius_m: float, safety_weight: float) -> Planner:
    """The skeleton planner, set up; one for each robot: it remembers its last route.

    Args:
        registry: the installed plugins.
        footprint_radius_m: the circular footprint.
        safety_weight: what a metre at the least clearance costs more than one with 1.5 m.
    """
    cls: type[Planner] = registry.get("planner", "skeleton")
    taste = {"comfortable": _ROOMY_M, "clearance_weight": safety_weight}
    planner = cls(cls.Options.model_validate(taste))
    planner.setup(RobotContext(footprint_radius_m=footprint_radius_m))
    return planner


def make_allocator(registry: Registry) -> Allocator:
    """The allocator ``auction``, which divides the work where there are several robots."""
    cls: type[Allocator] = registry.get("allocator", "auction")
    return cls(cls.Options())
