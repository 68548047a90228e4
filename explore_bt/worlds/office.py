"""Office floors: rows of rooms along one corridor, or round a core between two."""

from __future__ import annotations

import itertools

import numpy as np

from explore_bt.worlds.plan import WALL_M, Box, Door, FloorPlan, Space, rounded
from explore_bt.worlds.rows import RoomKind, Titles, fill_row

__all__ = ["draw_office"]

_FACADE = (
    RoomKind("office", 2.6, 4.6, 4.0),
    RoomKind("meeting room", 3.8, 6.0, 1.0, 2),
    RoomKind("open plan", 7.0, 10.5, 0.7, 1),
    RoomKind("kitchen", 3.0, 4.0, 0.4, 1),
)
_CORE = (
    RoomKind("toilets", 2.6, 3.6, 1.0, 2),
    RoomKind("storage", 2.0, 3.0, 1.0, 3),
    RoomKind("copy room", 2.2, 3.4, 1.0, 2),
    RoomKind("meeting room", 3.6, 5.5, 1.5, 3),
)
_DOORS_M = (0.8, 0.9, 0.9, 1.0)


def draw_office(rng: np.random.Generator) -> FloorPlan:
    """An office floor of 250 to 800 m² without furniture."""
    titles = Titles()
    length_m = rounded(float(rng.uniform(20.0, 34.0)))
    depths = [rounded(float(rng.uniform(4.0, 5.6))) for _ in range(2)]
    corridor_m = rounded(float(rng.uniform(1.6, 2.3)))
    core_m = rounded(float(rng.uniform(3.4, 4.8))) if rng.random() < 0.5 else 0.0
    middle_m = rounded(core_m + 2 * corridor_m) if core_m else corridor_m
    height_m, top = rounded(sum(depths) + middle_m), rounded(depths[0] + middle_m)
    lower = fill_row(rng, titles, _FACADE, (0.0, 0.0), length_m, depths[0], ("office",))
    upper = fill_row(
        rng, titles, (*_FACADE, _CORE[0]), (0.0, top), length_m, depths[1], ("kitchen", "toilets")
    )
    corridor = Space("corridor", "corridor", Box(0.0, depths[0], length_m, top), walled=False)
    plan = FloorPlan("office", Box(0.0, 0.0, length_m, height_m), [corridor, *lower, *upper])
    for room in (*lower, *upper):
        plan.join(corridor, room, _door(rng), _share(rng))
    for one, other in zip((*lower, *upper), (*lower[1:], *upper), strict=False):
        if {one.kind, other.kind} <= {"office", "open plan", "meeting room"} and rng.random() < 0.15:
            plan.join(one, other, _door(rng), float(rng.random()))
    if core_m:
        _add_core(rng, titles, plan, corridor_m, depths[0], core_m)
    return plan


def _add_core(
    rng: np.random.Generator,
    titles: Titles,
    plan: FloorPlan,
    corridor_m: float,
    depth_m: float,
    core_m: float,
) -> None:
    """Turn the one wide corridor into a ring of four about rooms without windows."""
    length_m = plan.outline.x1
    y0, y1 = rounded(depth_m + corridor_m), rounded(depth_m + corridor_m + core_m)
    core = fill_row(rng, titles, _CORE, (corridor_m, y0), rounded(length_m - 2 * corridor_m), core_m)
    sides = (
        Box(0.0, depth_m, length_m, y0),
        Box(0.0, y1, length_m, rounded(y1 + corridor_m)),
        Box(0.0, y0, corridor_m, y1),
        Box(rounded(length_m - corridor_m), y0, length_m, y1),
    )
    corridors = [
        Space(f"corridor {number}", "corridor", box, walled=False)
        for number, box in enumerate(sides, start=1)
    ]
    plan.spaces[0:1] = corridors
    for y, x in itertools.product((y0, y1), (corridor_m / 2, length_m - corridor_m / 2)):
        plan.openings.append(Door("corner", round(x, 3), y, corridor_m - WALL_M, upright=False))
    plan.spaces += core
    south, north = corridors[:2]
    for room in core:
        first, second = (south, north) if rng.random() < 0.5 else (north, south)
        plan.join(first, room, _door(rng), _share(rng))
        if room.kind == "meeting room" and rng.random() < 0.3:
            plan.join(second, room, _door(rng), _share(rng))


def _door(rng: np.random.Generator) -> float:
    return float(rng.choice(_DOORS_M))


def _share(rng: np.random.Generator) -> float:
    return float(rng.choice([0.0, 0.05, 0.95, 1.0, rng.random()]))
