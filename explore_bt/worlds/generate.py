"""Worlds by seed, so that nothing is tuned on the maps that judge."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from explore_bt.errors import WorldError
from explore_bt.worlds.apartment import draw_apartment
from explore_bt.worlds.furnishing import Furnisher
from explore_bt.worlds.furniture import furnish
from explore_bt.worlds.office import draw_office
from explore_bt.worlds.passages import draw_passages
from explore_bt.worlds.plan import FloorPlan
from explore_bt.worlds.world_text import world_text

__all__ = ["KINDS", "draw_plan", "generate_world"]

_DRAWN: Mapping[str, Callable[[np.random.Generator], FloorPlan]] = {
    "apartment": draw_apartment,
    "office": draw_office,
    "passages": draw_passages,
}
KINDS = tuple(_DRAWN)


def draw_plan(kind: str, seed: int) -> FloorPlan:
    """A floor plan with furniture and a start; the same seed gives the same plan.

    Furniture goes in only where every door of its space stays joined to every other by ways 0.6 m wide, so
    that all rooms can be reached; the doors are 0.8 m wide or more (but for the gaps of ``passages``).

    Raises:
        WorldError: the kind is unknown, or the seed below zero.
    """
    if kind not in _DRAWN:
        raise WorldError(f"there is no kind of world {kind}; choose one of {', '.join(KINDS)}")
    if seed < 0:
        raise WorldError(f"the seed is {seed}; expected 0 or more")
    rng = np.random.default_rng([seed, KINDS.index(kind)])
    plan = _DRAWN[kind](rng)
    if plan.start is not None:
        return plan
    plan = plan.transformed(_turned(rng))
    rooms = [Furnisher(space, [*plan.doors, *plan.openings], rng) for space in plan.spaces]
    for room, space in zip(rooms, plan.spaces, strict=True):
        furnish(room, space.kind)
        plan.pieces += room.pieces
    plan.start = (*rooms[0].widest(), 90.0 * int(rng.integers(0, 4)))
    return plan


def generate_world(kind: str, seed: int) -> str:
    """The text of a world file; see :func:`draw_plan`."""
    return world_text(draw_plan(kind, seed), f"Made by: explore-bt world --kind {kind} --seed {seed}")


def _turned(rng: np.random.Generator) -> Callable[[float, float], tuple[float, float]]:
    """Mirrored in x, in y, and turned by a swap of the axes, each or not."""
    mirror_x, mirror_y, swap = (bool(flag) for flag in rng.random(3) < 0.5)

    def where(x: float, y: float) -> tuple[float, float]:
        x, y = (-x if mirror_x else x), (-y if mirror_y else y)
        return (y, x) if swap else (x, y)

    return where
