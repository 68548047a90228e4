"""Colours of walls, floors and furniture."""

from __future__ import annotations

import numpy as np

__all__ = ["EDGE", "FLOOR", "SILL", "Tint", "furniture_tint", "wall_tint"]

Tint = tuple[float, float, float]
"""Red, green, blue, 0 to 1."""

FLOOR: Tint = (0.55, 0.43, 0.31)
SILL: Tint = (0.42, 0.33, 0.25)
EDGE: Tint = (0.62, 0.62, 0.60)
_WALLS: tuple[Tint, ...] = ((0.84, 0.80, 0.72), (0.74, 0.80, 0.84), (0.80, 0.84, 0.74), (0.86, 0.76, 0.70))
_FURNITURE: tuple[Tint, ...] = (
    (0.62, 0.44, 0.28),
    (0.36, 0.45, 0.58),
    (0.55, 0.30, 0.28),
    (0.42, 0.52, 0.38),
    (0.72, 0.66, 0.55),
    (0.40, 0.38, 0.42),
)


def wall_tint(rng: np.random.Generator) -> Tint:
    """Paint."""
    return _WALLS[int(rng.integers(len(_WALLS)))]


def furniture_tint(rng: np.random.Generator) -> Tint:
    """Wood, cloth, plastic."""
    return _FURNITURE[int(rng.integers(len(_FURNITURE)))]
