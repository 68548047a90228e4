"""How wide the widest way between two places is, to say what is missing when there is none."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from explore_bt_planners.heap import pop, push

__all__ = ["widest_squared"]


def widest_squared(
    squared: NDArray[np.int32], start: tuple[int, int], goal: tuple[int, int], budget: int = 60_000
) -> int | None:
    """Greatest lowest squared distance (cells²) over all ways through free cells.

    Returns:
        The value; 0 if no free cells join the two; None if ``budget`` cells did not tell.
    """
    cols = squared.shape[1]
    found = _flood(squared, start[0] * cols + start[1], goal[0] * cols + goal[1], budget)
    return None if found < 0 else int(found)


@njit(cache=True)
def _flood(squared, start, goal, budget):  # type: ignore[no-untyped-def]  # numba kernel
    """Dijkstra with the lowest value so far as the key, highest first."""
    rows, cols = squared.shape
    seen = np.zeros(rows * cols, dtype=np.bool_)
    room = min(4 * budget, squared.size) + 8  # a cell is pushed once
    keys, nodes = np.empty(room), np.empty(room, dtype=np.int64)
    size = push(keys, nodes, 0, -float(squared[start // cols, start % cols]), start)
    seen[start] = True
    for _ in range(budget):
        if size == 0:
            return 0
        level, here = keys[0], nodes[0]
        size = pop(keys, nodes, size)
        if here == goal:
            return -level
        r, c = here // cols, here % cols
        for k in range(4):
            nr = r + (k == 0) - (k == 1)
            nc = c + (k == 2) - (k == 3)
            if nr < 0 or nr >= rows or nc < 0 or nc >= cols:
                continue
            there = nr * cols + nc
            if squared[nr, nc] > 0 and not seen[there]:
                seen[there] = True
                size = push(keys, nodes, size, max(level, -float(squared[nr, nc])), there)
    return -1
