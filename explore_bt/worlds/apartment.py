"""Flats: a living room and a kitchen at one end, a corridor, bedrooms and bathrooms along it."""

from __future__ import annotations

import numpy as np

from explore_bt.worlds.plan import Box, FloorPlan, Space, rounded
from explore_bt.worlds.rows import RoomKind, Titles, fill_row

__all__ = ["draw_apartment"]

_ROOMS = (
    RoomKind("bedroom", 2.8, 4.2, 2.0),
    RoomKind("bathroom", 1.8, 2.5, 1.0, 1),
    RoomKind("study", 2.4, 3.2, 0.6, 1),
    RoomKind("storage", 1.4, 1.9, 0.3, 1),
)
_DOORS_M = (0.8, 0.85, 0.9, 0.9, 1.0)


def draw_apartment(rng: np.random.Generator) -> FloorPlan:
    """A flat of 60 to 130 m² without furniture."""
    titles = Titles()
    left_m = rounded(float(rng.uniform(4.0, 5.6)))
    below_m = 0.0 if rng.random() < 0.25 else rounded(float(rng.uniform(3.0, 4.0)))
    above_m = rounded(float(rng.uniform(3.0, 4.2)))
    corridor_m = rounded(float(rng.uniform(1.2, 1.6)))
    length_m = rounded(float(rng.uniform(5.5, 9.5)))
    top, width_m = rounded(below_m + corridor_m), rounded(left_m + length_m)
    height_m = rounded(top + above_m)
    has_kitchen_left = below_m > 0.0
    living_top = top if has_kitchen_left else height_m
    living = Space(titles.of("living room"), "living room", Box(0.0, 0.0, left_m, living_top))
    corridor = Space("corridor", "corridor", Box(left_m, below_m, width_m, top), walled=False)
    kitchen_kind = RoomKind("kitchen", 2.6, 3.6, 1.0, 1)
    kinds = _ROOMS if has_kitchen_left else (*_ROOMS, kitchen_kind)
    needed = ("bathroom",) if has_kitchen_left else ("bathroom", "kitchen")
    upper = fill_row(rng, titles, kinds, (left_m, top), length_m, above_m, needed)
    lower = fill_row(rng, titles, _ROOMS, (left_m, 0.0), length_m, below_m, ("bedroom",)) if below_m else []
    plan = FloorPlan("apartment", Box(0.0, 0.0, width_m, height_m), [living, corridor, *upper, *lower])
    plan.join(living, corridor, min(_door(rng), rounded(corridor_m - 0.4)), 0.5)
    for room in (*upper, *lower):
        plan.join(corridor, room, _door(rng), _share(rng))
    if has_kitchen_left:
        kitchen = Space(titles.of("kitchen"), "kitchen", Box(0.0, top, left_m, height_m))
        plan.spaces.insert(1, kitchen)
        plan.join(living, kitchen, float(rng.choice([*_DOORS_M, 1.4, 1.8])), float(rng.random()))
    _join_suites(rng, plan, [*upper, *lower])
    return plan


def _join_suites(rng: np.random.Generator, plan: FloorPlan, rooms: list[Space]) -> None:
    """Now and then a second door, from a bedroom into its bathroom: a flat with a loop."""
    for bedroom in (room for room in rooms if room.kind == "bedroom"):
        for bathroom in (room for room in rooms if room.kind == "bathroom"):
            if rng.random() < 0.35:
                plan.join(bedroom, bathroom, 0.8, float(rng.random()))


def _door(rng: np.random.Generator) -> float:
    return float(rng.choice(_DOORS_M))


def _share(rng: np.random.Generator) -> float:
    """Doors are mostly near a corner of the room."""
    return float(rng.choice([0.0, 0.05, 0.95, 1.0, rng.random()]))
