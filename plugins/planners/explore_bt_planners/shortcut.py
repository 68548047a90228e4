"""Straight lines in place of needless detours, where clearance is worth what it costs."""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from explore_bt_planners.polyline import length_of, subdivide
from explore_bt_planners.sampling import clearance_at, segment_is_clear
from explore_bt_planners.search import ClearancePrice, price_at
from explore_bt_planners.terrain import SLACK_M

__all__ = ["polyline_cost", "take_shortcuts"]

_SPACING_M, _REACH_M = 0.3, 6.0
_ROUNDS, _CLEARLY = 5, 0.97
_SAMPLE_CELLS = 2.0  # for the price; the floor is then checked finely


def take_shortcuts(
    polyline: NDArray[np.float64],
    clearance_m: NDArray[np.float32],
    price: ClearancePrice,
    resolution_m: float,
) -> NDArray[np.float64]:
    """The cheapest way along the polyline that may leave it by straight lines between its points.

    Dynamic programming over points 0.3 m apart; a line may span 6 m and keeps the price's floor everywhere.
    The pieces of the polyline itself stay as they are. Repeated on its own result while that gets clearly
    shorter: each round cuts the corners that the one before has left.

    Args:
        polyline: (N, 2) float64 column, row as real numbers of cells.
        clearance_m: (rows, cols) float32.
        price: what a metre costs.
        resolution_m: metres per cell.

    Returns:
        (M, 2) float64, first and last point unchanged.
    """
    line, spacing_cells = polyline, _SPACING_M / resolution_m
    for _ in range(_ROUNDS):
        nodes = _spaced(line, spacing_cells)
        terms = price.terms
        shorter = _cheapest(line, nodes, clearance_m, *terms, _REACH_M / resolution_m, resolution_m)
        enough = length_of(shorter) > _CLEARLY * length_of(line)
        line = subdivide(shorter, spacing_cells)
        if enough:
            break
    return line


def polyline_cost(
    polyline: NDArray[np.float64],
    clearance_m: NDArray[np.float32],
    price: ClearancePrice,
    resolution_m: float,
) -> float:
    """Price of a way in cells of roomy floor; infinite where it falls below the price's floor."""
    terms = price.terms
    return float(_polyline_cost(polyline, clearance_m, *terms, resolution_m))


@njit(cache=True)
def _polyline_cost(polyline, clearance, floor, comfortable, weight, slow, resolution):  # type: ignore[no-untyped-def]  # numba kernel
    total, lowest = 0.0, floor - SLACK_M
    for i in range(len(polyline) - 1):
        u0, v0 = polyline[i]
        u1, v1 = polyline[i + 1]
        if not segment_is_clear(clearance, u0, v0, u1, v1, lowest, resolution):
            return np.inf
        total += _line_cost(clearance, u0, v0, u1, v1, lowest, comfortable, weight, slow, np.inf)
    return total


@njit(cache=True)
def _spaced(polyline, spacing_cells):  # type: ignore[no-untyped-def]  # numba kernel
    """Indices of points about ``spacing_cells`` apart, both ends included."""
    total = 0.0
    for i in range(1, len(polyline)):
        u, v = polyline[i] - polyline[i - 1]
        total += math.hypot(u, v)
    step = total / max(1, round(total / spacing_cells))
    picked = np.empty(len(polyline), dtype=np.int64)
    picked[0] = 0
    count, along, due = 1, 0.0, step
    for i in range(1, len(polyline) - 1):
        u, v = polyline[i] - polyline[i - 1]
        along += math.hypot(u, v)
        if along >= due:
            picked[count] = i
            count += 1
            due = step * (math.floor(along / step) + 1)
    picked[count] = len(polyline) - 1
    return picked[: count + 1].copy()


@njit(cache=True)
def _line_cost(clearance, u0, v0, u1, v1, floor, comfortable, weight, slow, give_up_above):  # type: ignore[no-untyped-def]  # numba kernel
    """Price of a straight line by the cells it crosses; infinite if too tight or above the bound."""
    length = math.hypot(u1 - u0, v1 - v0)
    steps = max(1, math.ceil(length / _SAMPLE_CELLS))
    piece = length / steps
    surplus = 0.0
    for k in range(steps):
        t = (k + 0.5) / steps
        here = clearance[int(v0 + t * (v1 - v0)), int(u0 + t * (u1 - u0))]
        if here < floor:
            return np.inf
        surplus += piece * (price_at(here, floor, comfortable, weight, slow) - 1.0)
        if length + surplus >= give_up_above:
            return np.inf
    return length + surplus


@njit(cache=True)
def _cheapest(polyline, nodes, clearance, floor, comfortable, weight, slow, reach, resolution):  # type: ignore[no-untyped-def]  # numba kernel
    count = len(nodes)
    best = np.full(count, np.inf)
    came = np.zeros(count, dtype=np.int64)
    straight = np.zeros(count, dtype=np.bool_)
    best[0] = 0.0
    for j in range(1, count):
        along = best[j - 1]
        for p in range(nodes[j - 1], nodes[j]):
            u0, v0 = polyline[p]
            u1, v1 = polyline[p + 1]
            here = max(floor, clearance_at(clearance, 0.5 * (u0 + u1), 0.5 * (v0 + v1)))
            along += math.hypot(u1 - u0, v1 - v0) * price_at(here, floor, comfortable, weight, slow)
        best[j], came[j] = along * (1.0 + 1e-9), j - 1
        u1, v1 = polyline[nodes[j]]
        for i in range(j):  # far ones first: they often win, and then rule the near ones out
            u0, v0 = polyline[nodes[i]]
            length = math.hypot(u1 - u0, v1 - v0)
            if length > reach or best[i] + length >= best[j]:
                continue
            cost = best[i] + _line_cost(
                clearance, u0, v0, u1, v1, floor, comfortable, weight, slow, best[j] - best[i]
            )
            if cost < best[j] and segment_is_clear(clearance, u0, v0, u1, v1, floor, resolution):
                best[j], came[j], straight[j] = cost, i, True
    return _unroll(polyline, nodes, came, straight)


@njit(cache=True)
def _unroll(polyline, nodes, came, straight):  # type: ignore[no-untyped-def]  # numba kernel
    kept = np.zeros(len(polyline), dtype=np.bool_)
    j = len(nodes) - 1
    kept[nodes[j]] = True
    while j > 0:
        i = came[j]
        kept[nodes[i]] = True
        if not straight[j]:
            kept[nodes[i] : nodes[j]] = True
        j = i
    return polyline[kept]
