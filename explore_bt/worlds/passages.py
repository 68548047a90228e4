"""A course of gaps: a hall with a chamber behind each, from 0.5 to 1.2 m in steps of 5 cm."""

from __future__ import annotations

import numpy as np

from explore_bt.worlds.plan import Box, Door, FloorPlan, Piece, Space

__all__ = ["GAPS_M", "draw_passages"]

GAPS_M = tuple(round(0.5 + 0.05 * step, 2) for step in range(15))
_CHAMBER_M, _DEPTH_M, _HALL_M = 3.0, 2.9, 2.4
_SCREEN_M, _SCREEN_OFF_M = 1.55, 1.4  # leaves a way wider than any gap
_GAP_AT_M = 0.9
_CELL_M = 0.05


def draw_passages(rng: np.random.Generator) -> FloorPlan:
    """The seed shuffles the gaps; a screen hides most of each chamber from who only looks in."""
    columns = -(-len(GAPS_M) // 2)
    length_m = columns * _CHAMBER_M
    height_m = 2 * _DEPTH_M + _HALL_M
    hall = Space("hall", "hall", Box(0.0, _DEPTH_M, length_m, _DEPTH_M + _HALL_M), walled=False)
    plan = FloorPlan("passages", Box(0.0, 0.0, length_m, height_m), [hall])
    for place, number in enumerate(rng.permutation(len(GAPS_M)).tolist()):
        gap_m, below = GAPS_M[number], place < columns
        x0 = _CHAMBER_M * (place % columns)
        y0 = 0.0 if below else _DEPTH_M + _HALL_M
        box = Box(round(x0, 2), round(y0, 2), round(x0 + _CHAMBER_M, 2), round(y0 + _DEPTH_M, 2))
        name = f"chamber {100 * gap_m:.0f}"
        plan.spaces.append(Space(name, "chamber", box))
        wall_y = _DEPTH_M if below else _DEPTH_M + _HALL_M
        odd = round(gap_m / _CELL_M) % 2 == 1  # its edges lie on multiples of 5 cm all the same
        mid = round(x0 + _GAP_AT_M + (0.5 * _CELL_M if odd else 0.0), 3)
        plan.doors.append(Door(f"gap of {100 * gap_m:.0f} cm", mid, wall_y, gap_m, upright=False))
        screen_y = wall_y + (-_SCREEN_OFF_M if below else _SCREEN_OFF_M)
        screen = (x0 + 0.05, screen_y - 0.05, x0 + 0.05 + _SCREEN_M, screen_y + 0.05)
        plan.pieces.append(Piece(f"screen of {name}", "box", tuple(round(v, 3) for v in screen), 2.0))
    plan.start = (round(length_m / 2, 2), _DEPTH_M + _HALL_M / 2, 0.0)
    return plan
