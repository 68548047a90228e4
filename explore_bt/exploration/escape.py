"""The way out of a start that is tighter than the footprint asks."""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from explore_bt.exploration.kernel_input import read_only

__all__ = ["ways_out"]

_DIAGONAL = math.sqrt(2.0)


@njit(cache=True)
def _climb(clearance, radius, reach, row0, col0):  # type: ignore[no-untyped-def]  # numba kernel
    """Shortest ways from one start along which clearance never falls, over a window about it, in cells."""
    rows, cols = clearance.shape
    span = math.ceil(reach) + 1
    size = 2 * span + 1
    distance = np.full((size, size), math.inf)
    distance[span, span] = 0.0
    changed = True
    while changed:
        changed = False
        for i in range(size * size * 9):
            at, step = i // 9, i % 9
            u, v = at // size, at % size
            row, col = row0 - span + u, col0 - span + v
            if distance[u, v] > reach or clearance[row, col] >= radius:
                continue
            du, dv = step // 3 - 1, step % 3 - 1
            r, c = row + du, col + dv
            if r < 0 or r >= rows or c < 0 or c >= cols or clearance[r, c] <= 0.0:
                continue
            far = distance[u, v] + (_DIAGONAL if du != 0 and dv != 0 else 1.0)
            if clearance[r, c] >= clearance[row, col] and far <= reach and far < distance[u + du, v + dv]:
                distance[u + du, v + dv] = far
                changed = True
    return distance


def ways_out(
    clearance_m: NDArray[np.float32],
    start_cells: NDArray[np.int64],
    radius_m: float,
    reach_cells: float,
) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """The first cells with clearance ≥ r on the ways out of each start, and how far they are.

    Args:
        clearance_m: (rows, cols) float32, metres.
        start_cells: (N, 2) int64, inside the grid. One with clearance ≥ r is its own way out; one that
            the map holds for solid is left all the same, for the robot stands there.
        radius_m: r.
        reach_cells: longest climb.

    Returns:
        (K, 2) int64 rows and columns, each once, and (K,) float64 distances in cells, nearest first.
    """
    span = math.ceil(reach_cells) + 1
    best: dict[tuple[int, int], float] = {}
    for row, col in start_cells.tolist():
        climbed = _climb(read_only(clearance_m), radius_m, reach_cells, row, col)
        for u, v in np.argwhere(np.isfinite(climbed)).tolist():
            cell = (row - span + u, col - span + v)
            if clearance_m[cell] >= radius_m and clearance_m[cell] > 0.0:
                best[cell] = min(climbed[u, v], best.get(cell, math.inf))
    ordered = sorted(best, key=lambda cell: (best[cell], cell))
    return (
        np.array(ordered, dtype=np.int64).reshape(-1, 2),
        np.array([best[cell] for cell in ordered], dtype=np.float64),
    )
