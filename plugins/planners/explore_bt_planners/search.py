"""A* over the cells of a map, in slices so that the caller can give up in between."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray

from explore_bt.errors import Cancelled
from explore_bt_planners.heap import pop, push

__all__ = ["ClearancePrice", "find_costs", "find_route", "price_at"]

_ROW = (0, 0, 1, -1, 1, 1, -1, -1)
_COL = (1, -1, 0, 0, 1, -1, 1, -1)
_FOUND, _EXHAUSTED, _OPEN = 1, 2, 0
_CLOSED, _START = 16, 9
_SLICE = 4000
_SLOWEST_SHARE = 0.2  # of full speed, as controllers drive where it is tight
_NOWHERE = -1  # a goal that no search ends at: all of the floor is settled


@dataclass(frozen=True, slots=True)
class ClearancePrice:
    """What a metre costs where it is tight: 1 from ``comfortable_m`` up, ``1 + weight`` at the floor.

    With ``slow_m``, the time it takes instead, 1 being a metre at full speed: speed falls in proportion over
    that much clearance below ``comfortable_m``, to a fifth.
    """

    floor_m: float
    comfortable_m: float
    weight: float
    slow_m: float = 0.0

    @property
    def terms(self) -> tuple[float, float, float, float]:
        """For the kernels."""
        return (self.floor_m, self.comfortable_m, self.weight, self.slow_m)


@njit(cache=True)
def price_at(clearance, floor, comfortable, weight, slow):  # type: ignore[no-untyped-def]  # numba kernel
    """Cost of a metre at this clearance."""
    if clearance >= comfortable:
        return 1.0
    if slow > 0.0:
        return 1.0 / max(1.0 - (comfortable - clearance) / slow, _SLOWEST_SHARE)
    share = (comfortable - clearance) / max(comfortable - floor, 1e-9)
    return 1.0 + weight * share * share


def find_route(
    allowed: NDArray[np.bool_],
    passable: NDArray[np.bool_],
    clearance_m: NDArray[np.float32],
    price: ClearancePrice,
    start: tuple[int, int],
    goal: tuple[int, int],
    cancelled: Callable[[], bool],
) -> NDArray[np.int64] | None:
    """The cheapest 8-connected way through allowed cells.

    A diagonal step needs a passable cell beside it: with two it cuts the corner they leave, with one it
    goes through that cell. So pieces of passable space are joined through edges only.

    Args:
        allowed: (rows, cols) bool, cells the route may use; holds start and goal.
        passable: (rows, cols) bool, cells that a diagonal step may touch.
        clearance_m: (rows, cols) float32.
        price: what a metre costs.
        start: (row, col).
        goal: (row, col).
        cancelled: asked every few thousand cells.

    Returns:
        (N, 2) int64 rows and columns, start and goal included, or None if there is no way. Every diagonal
        step of it has passable cells on both sides.

    Raises:
        Cancelled: the caller has given up.
    """
    cols = allowed.shape[1]
    last = goal[0] * cols + goal[1]
    state, _, mark = _search(allowed, passable, clearance_m, price, start, last, cancelled)
    return _round_corners(_trace(mark, cols, last), passable) if state == _FOUND else None


def find_costs(
    allowed: NDArray[np.bool_],
    passable: NDArray[np.bool_],
    clearance_m: NDArray[np.float32],
    price: ClearancePrice,
    start: tuple[int, int],
    goals: NDArray[np.int64],
    cancelled: Callable[[], bool],
) -> NDArray[np.float64]:
    """What the cheapest ways of ``find_route`` from one start to many goals cost, in one pass.

    Args:
        allowed: see ``find_route``.
        passable: see ``find_route``.
        clearance_m: see ``find_route``.
        price: what a metre costs.
        start: (row, col).
        goals: (N, 2) int64 rows and columns.
        cancelled: asked every few thousand cells.

    Returns:
        (N,) float64 cells of roomy floor; inf where there is no way.

    Raises:
        Cancelled: the caller has given up.
    """
    _, cost, mark = _search(allowed, passable, clearance_m, price, start, _NOWHERE, cancelled)
    at = goals @ np.array([allowed.shape[1], 1])
    return np.where(mark[at] & _CLOSED, cost[at], np.inf)


def _search(
    allowed: NDArray[np.bool_],
    passable: NDArray[np.bool_],
    clearance_m: NDArray[np.float32],
    price: ClearancePrice,
    start: tuple[int, int],
    last: int,
    cancelled: Callable[[], bool],
) -> tuple[int, NDArray[np.float64], NDArray[np.uint8]]:
    """State, costs and marks once the cell ``last`` is found, or no cell is left."""
    rows, cols = allowed.shape
    cost = np.zeros(rows * cols)  # pages never touched are never made: the map may be huge
    mark = np.zeros(rows * cols, dtype=np.uint8)
    keys, nodes = np.empty(8 * _SLICE + 64), np.empty(8 * _SLICE + 64, dtype=np.int64)
    first = start[0] * cols + start[1]
    keys[0], nodes[0], size, state = 0.0, first, 1, _OPEN
    mark[first] = _START
    terms = price.terms
    while state == _OPEN:
        if cancelled():
            raise Cancelled("the search was cancelled by its caller")
        if keys.size < size + 8 * _SLICE:
            keys = np.concatenate((keys[:size], np.empty(size + 8 * _SLICE)))
            nodes = np.concatenate((nodes[:size], np.empty(size + 8 * _SLICE, dtype=np.int64)))
        state, size = _expand(
            allowed, passable, clearance_m, *terms, last, _SLICE, keys, nodes, size, cost, mark
        )
    return state, cost, mark


@njit(cache=True)
def _expand(  # type: ignore[no-untyped-def]  # numba kernel
    allowed,
    passable,
    clearance,
    floor,
    comfortable,
    weight,
    slow,
    goal,
    budget,
    keys,
    nodes,
    size,
    cost,
    mark,
):
    """Expand up to ``budget`` cells; the low bits of ``mark`` are the step by which a cell was reached."""
    rows, cols = allowed.shape
    goal_row, goal_col = goal // cols, goal % cols
    for _ in range(budget):
        if size == 0:
            return _EXHAUSTED, size
        here = nodes[0]
        size = pop(keys, nodes, size)
        if mark[here] & _CLOSED:
            continue
        mark[here] |= _CLOSED
        if here == goal:
            return _FOUND, size
        r, c = here // cols, here % cols
        price_here = price_at(clearance[r, c], floor, comfortable, weight, slow)
        for k in range(8):
            nr, nc = r + _ROW[k], c + _COL[k]
            if nr < 0 or nr >= rows or nc < 0 or nc >= cols or not allowed[nr, nc]:
                continue
            beside = 0.0  # price of the one passable cell beside a diagonal step, 0 if there are two
            if k >= 4 and not (passable[r, nc] and passable[nr, c]):
                sr, sc = (r, nc) if passable[r, nc] else (nr, c)
                if not passable[sr, sc] or allowed[sr, sc]:
                    continue  # no way, or one that straight steps find
                beside = price_at(clearance[sr, sc], floor, comfortable, weight, slow)
            there = nr * cols + nc
            if mark[there] & _CLOSED:
                continue
            price_there = price_at(clearance[nr, nc], floor, comfortable, weight, slow)
            step = 1.0 if k < 4 or beside > 0.0 else math.sqrt(2.0)
            total = cost[here] + 0.5 * step * (price_here + price_there) + beside
            if mark[there] == 0 or total < cost[there]:
                cost[there] = total
                mark[there] = k + 1
                dr, dc = abs(nr - goal_row), abs(nc - goal_col)
                octile = max(dr, dc) + (math.sqrt(2.0) - 1.0) * min(dr, dc) if goal >= 0 else 0.0
                size = push(keys, nodes, size, total + octile, there)
    return _OPEN, size


@njit(cache=True)
def _trace(mark, cols, goal):  # type: ignore[no-untyped-def]  # numba kernel
    count, node = 1, goal
    while mark[node] & 15 != _START:
        k = (mark[node] & 15) - 1
        node -= _ROW[k] * cols + _COL[k]
        count += 1
    route = np.empty((count, 2), dtype=np.int64)
    node = goal
    for i in range(count - 1, -1, -1):
        route[i, 0], route[i, 1] = node // cols, node % cols
        if i > 0:
            k = (mark[node] & 15) - 1
            node -= _ROW[k] * cols + _COL[k]
    return route


@njit(cache=True)
def _round_corners(route, passable):  # type: ignore[no-untyped-def]  # numba kernel
    """Put in the cell through which a diagonal step beside an impassable cell has to go."""
    wide = np.empty((2 * len(route), 2), dtype=np.int64)
    wide[0] = route[0]
    count = 1
    for i in range(1, len(route)):
        r0, c0 = route[i - 1]
        r1, c1 = route[i]
        if r0 != r1 and c0 != c1 and not (passable[r0, c1] and passable[r1, c0]):
            if passable[r0, c1]:
                wide[count, 0], wide[count, 1] = r0, c1
            else:
                wide[count, 0], wide[count, 1] = r1, c0
            count += 1
        wide[count] = route[i]
        count += 1
    return wide[:count].copy()
