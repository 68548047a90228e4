"""Uphill on the distance transform: from anywhere to the medial axis, or out of a tight spot."""

from __future__ import annotations

import heapq
import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

__all__ = ["ascend", "nearest_target"]


@njit(cache=True)
def ascend(squared, walkable, target, row, col):  # type: ignore[no-untyped-def]  # numba kernel
    """Cells from (row, col) to the first target uphill; clearance rises with every step.

    Args:
        squared: (rows, cols) int32, squared distance to the nearest obstacle, cells².
        walkable: (rows, cols) bool, cells beside a diagonal step.
        target: (rows, cols) bool, where to stop.
        row: of the first cell.
        col: of the first cell.

    Returns:
        (N, 2) int64 rows and columns, the first cell included. The last one is no target if the way up
        ended on a summit before.
    """
    rows, cols = squared.shape
    way = [(row, col)]
    while not target[row, col]:
        best, best_row, best_col = squared[row, col], -1, -1
        for dr in range(-1, 2):
            for dc in range(-1, 2):
                r, c = row + dr, col + dc
                if r < 0 or r >= rows or c < 0 or c >= cols or squared[r, c] <= best:
                    continue
                if dr != 0 and dc != 0 and not (walkable[r, col] and walkable[row, c]):
                    continue
                best, best_row, best_col = squared[r, c], r, c
        if best_row < 0:
            break
        row, col = best_row, best_col
        way.append((row, col))
    cells = np.empty((len(way), 2), dtype=np.int64)
    for i in range(len(way)):
        cells[i, 0], cells[i, 1] = way[i]
    return cells


def nearest_target(
    walkable: NDArray[np.bool_], target: NDArray[np.bool_], start: tuple[int, int], radius_cells: float
) -> NDArray[np.int64] | None:
    """The shortest way through walkable cells to a target within a disc: where ascent ends on a summit.

    Args:
        walkable: (rows, cols) bool; the start itself need not be.
        target: (rows, cols) bool.
        start: (row, col).
        radius_cells: of the disc around the start.

    Returns:
        (N, 2) int64 rows and columns, the start included, or None.
    """
    rows, cols = walkable.shape
    costs: dict[tuple[int, int], float] = {start: 0.0}
    came: dict[tuple[int, int], tuple[int, int]] = {}
    heap = [(0.0, start)]
    while heap:
        cost, here = heapq.heappop(heap)
        if cost > costs[here]:
            continue
        if target[here]:
            way = [here]
            while way[-1] in came:
                way.append(came[way[-1]])
            return np.array(way[::-1], dtype=np.int64)
        for dr, dc in ((0, 1), (0, -1), (1, 0), (-1, 0)):
            there = (here[0] + dr, here[1] + dc)
            inside = 0 <= there[0] < rows and 0 <= there[1] < cols
            if not inside or not walkable[there]:
                continue
            if math.hypot(there[0] - start[0], there[1] - start[1]) > radius_cells:
                continue
            if cost + 1.0 < costs.get(there, math.inf):
                costs[there], came[there] = cost + 1.0, here
                heapq.heappush(heap, (cost + 1.0, there))
    return None
