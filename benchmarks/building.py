"""A made-up building of any size, for benchmarks that need no data."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from explore_bt.types import FREE, OCCUPIED, OccupancyGrid

__all__ = ["make_building"]

CELL_M = 0.05
_WALL = 3


def make_building(cells: int, seed: int = 0) -> OccupancyGrid:
    """Rooms of 3 to 8 m, doors of 0.8 to 1.2 m between nearly all neighbours, furniture.

    Args:
        cells: rows and columns, of 5 cm.
        seed: of the building.
    """
    rng = np.random.default_rng([seed, cells])
    plan = np.full((cells, cells), FREE, dtype=np.int8)
    lines = [_wall_lines(cells, rng) for _ in range(2)]
    for row in lines[0]:
        plan[row : row + _WALL] = OCCUPIED
    for col in lines[1]:
        plan[:, col : col + _WALL] = OCCUPIED
    for view, walls, sides in ((plan, lines[0], lines[1]), (plan.T, lines[1], lines[0])):
        for wall in walls[1:-1]:
            for low, high in pairwise(sides):
                _open_door(view, int(wall), int(low), int(high), rng)
    _furnish(plan, rng)
    return OccupancyGrid(plan, CELL_M, (0.0, 0.0), revision=1)


def _wall_lines(cells: int, rng: np.random.Generator) -> NDArray[np.int64]:
    lines = np.concatenate(([0], np.cumsum(rng.integers(60, 160, size=cells // 60))))
    return np.append(lines[lines < cells - 60], cells - _WALL)


def _open_door(plan: NDArray[np.int8], wall: int, low: int, high: int, rng: np.random.Generator) -> None:
    width = int(rng.integers(16, 25))
    if rng.random() < 0.85:
        at = int(rng.integers(low + _WALL + 4, high - width - 4))
        plan[wall : wall + _WALL, at : at + width] = FREE


def _furnish(plan: NDArray[np.int8], rng: np.random.Generator) -> None:
    rows, cols = plan.shape
    for row, col in rng.integers(0, (rows, cols), size=(rows * cols // 2500, 2)):
        height, width = rng.integers(2, 24, size=2)
        around = plan[max(row - 14, 0) : row + height + 14, max(col - 14, 0) : col + width + 14]
        if (around == FREE).all():  # a passage is left on every side
            plan[row : row + height, col : col + width] = OCCUPIED
