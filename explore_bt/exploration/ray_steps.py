"""How a ray sets out over a grid: what every walk along it begins with."""

from __future__ import annotations

import math

from numba import njit

__all__ = ["ray_steps"]

_ALONG = 1e-12
"""A ray that leaves its axis by less never leaves its row."""


@njit(cache=True)
def ray_steps(u, v, du, dv):  # type: ignore[no-untyped-def]  # numba kernel
    """Cell, step, length of a cell and length to the first border, rows before columns.

    After Amanatides & Woo, 1987. Lengths count in cells; (u, v) and (du, dv) are the eye and the ray's unit
    vector in columns and rows. A ray along an axis has inf where it never meets a border.
    """
    row, col = math.floor(v), math.floor(u)
    step_row, step_col = (1 if dv > 0.0 else -1), (1 if du > 0.0 else -1)
    per_row = next_row = per_col = next_col = math.inf
    if abs(dv) >= _ALONG:
        per_row = abs(1.0 / dv)
        next_row = ((row + 1 - v) if dv > 0.0 else (v - row)) * per_row
    if abs(du) >= _ALONG:
        per_col = abs(1.0 / du)
        next_col = ((col + 1 - u) if du > 0.0 else (u - col)) * per_col
    return row, col, step_row, step_col, per_row, per_col, next_row, next_col
