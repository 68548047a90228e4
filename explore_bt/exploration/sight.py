"""Lines of sight across known free floor."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray

from explore_bt.exploration.kernel_input import read_only
from explore_bt.types import FREE, OccupancyGrid

__all__ = ["Sights", "sights_of"]

_TURN = 2.0 * math.pi
_MOST_TARGETS = 12


@dataclass(frozen=True, slots=True, eq=False)
class Sights:
    """Places that see a set of cells, and under which angle: N rows each.

    Attributes:
        places: (N, 2) int64 rows and columns.
        distance_m: mean distance to the cells seen from there.
        heading_rad: middle of the angle they fill, ``map`` frame.
        width_rad: that angle; a full turn for a place among them.
    """

    places: NDArray[np.int64]
    distance_m: NDArray[np.float64]
    heading_rad: NDArray[np.float64]
    width_rad: NDArray[np.float64]


@njit(cache=True)
def _is_clear(cells, row, col, to_row, to_col):  # type: ignore[no-untyped-def]  # numba kernel
    """Whether all cells on the line between two cells' centres are free.

    In whole numbers, so exact; through a common corner the line passes if either cell beside it is free.
    """
    step_row, step_col = (1 if to_row > row else -1), (1 if to_col > col else -1)
    span_row, span_col = abs(to_row - row), abs(to_col - col)
    lead = span_col - span_row  # above zero: the column border comes first
    if cells[row, col] != FREE:
        return False
    while row != to_row or col != to_col:
        if lead > 0:
            col += step_col
            lead -= 2 * span_row
        elif lead < 0:
            row += step_row
            lead += 2 * span_col
        else:
            if cells[row + step_row, col] != FREE and cells[row, col + step_col] != FREE:
                return False
            row += step_row
            col += step_col
            lead += 2 * (span_col - span_row)
        if cells[row, col] != FREE:
            return False
    return True


@njit(cache=True)
def _angle_filled(bearings, near, half_gap):  # type: ignore[no-untyped-def]  # numba kernel
    """Middle and width of the smallest angle that holds all bearings, each target having some width."""
    ordered = np.sort(bearings)
    gap, start = ordered[0] + _TURN - ordered[-1], ordered[0]
    for i in range(1, ordered.size):
        if ordered[i] - ordered[i - 1] > gap:
            gap, start = ordered[i] - ordered[i - 1], ordered[i]
    if near < 1.0:
        return start + 0.5 * (_TURN - gap), _TURN
    width = _TURN - gap
    return start + 0.5 * width, min(width + 2.0 * math.atan2(half_gap, near), _TURN)


@njit(cache=True)
def _look(cells, places, targets, reach, half_gap):  # type: ignore[no-untyped-def]  # numba kernel
    """Targets seen from each place: how many, mean distance, middle and width of their angle (cells)."""
    found = np.zeros((places.shape[0], 4))
    bearings = np.empty(targets.shape[0])
    for i in range(places.shape[0]):
        row, col = places[i]
        count, total, near = 0, 0.0, math.inf
        for j in range(targets.shape[0]):
            off_row, off_col = targets[j, 0] - row, targets[j, 1] - col
            far = math.hypot(off_row, off_col)
            if far <= reach and _is_clear(cells, row, col, targets[j, 0], targets[j, 1]):
                bearings[count] = math.atan2(off_row, off_col)
                count += 1
                total += far
                near = min(near, far)
        if count > 0:
            middle, width = _angle_filled(bearings[:count], near, half_gap)
            found[i, 0], found[i, 1], found[i, 2], found[i, 3] = count, total / count, middle, width
    return found


def sights_of(
    grid: OccupancyGrid, places: NDArray[np.int64], cells: NDArray[np.int64], range_m: float
) -> Sights:
    """The places from which some of the cells are in range and in plain view over free floor.

    At most 12 of the cells, evenly spread along them, stand for all.

    Args:
        grid: the map.
        places: (N, 2) int64 rows and columns to look from.
        cells: (M, 2) int64 rows and columns to be seen, M ≥ 1.
        range_m: the lidar's range.
    """
    stride = -(-len(cells) // _MOST_TARGETS)
    targets = cells[stride // 2 :: stride]
    reach = range_m / grid.resolution_m
    close = places[_are_near(places, cells, reach)]
    found = _look(read_only(grid.cells), read_only(close), read_only(targets), reach, 0.5 + 0.5 * stride)
    sees = found[:, 0] > 0
    distance, heading, width = found[sees, 1:].T
    return Sights(close[sees], distance * grid.resolution_m, heading, width)


def _are_near(places: NDArray[np.int64], cells: NDArray[np.int64], reach: float) -> NDArray[np.bool_]:
    """(N,) bool: places within reach of the cells' bounding box."""
    off = np.maximum(np.maximum(cells.min(axis=0) - places, places - cells.max(axis=0)), 0)
    return (off**2).sum(axis=1) <= reach**2
