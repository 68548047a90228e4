"""Voxels of all submaps, seen from above: what a robot of some height can drive over."""

from __future__ import annotations

import numpy as np
from numba import njit

from explore_bt.types import FREE, OCCUPIED, UNKNOWN
from explore_bt_slam.arrays import Bools, Bytes, Floats, Ints, Ints32
from explore_bt_slam.voxel_kernels import BRICK, DECISIVE

__all__ = ["mark_columns", "project"]

_FREE, _OCCUPIED, _UNKNOWN = FREE, OCCUPIED, UNKNOWN
_ENOUGH = 0.5


@njit(cache=True)
def mark_columns(
    wanted: Bools, corner: Floats, cell: float, pose: Floats, half: int, mask: Bools, row0: int, col0: int
) -> None:
    """Want every cell whose centre lies in a marked column of a submap.

    Args:
        wanted: (rows, cols) bool, changed in place.
        corner: (2,) x, y of the lower left corner of these cells, metres, ``map`` frame.
        cell: side of a cell and of a voxel, metres.
        pose: (3,) of the submap, ``map`` frame.
        half: cells from the submap's corner to its centre.
        mask: (r, c) bool: columns of the submap.
        row0: row in the submap of ``mask[0, 0]``.
        col0: its column.
    """
    cos, sin = np.cos(pose[2]), np.sin(pose[2])
    for row in range(wanted.shape[0]):
        dy = corner[1] + (row + 0.5) * cell - pose[1]
        for col in range(wanted.shape[1]):
            dx = corner[0] + (col + 0.5) * cell - pose[0]
            c = int(np.floor((cos * dx + sin * dy) / cell)) + half - col0
            r = int(np.floor((-sin * dx + cos * dy) / cell)) + half - row0
            if 0 <= r < mask.shape[0] and 0 <= c < mask.shape[1] and mask[r, c]:
                wanted[row, col] = True


@njit(cache=True)
def project(
    cells: Bytes,
    wanted: Bools,
    corner: Floats,
    cell: float,
    order: Ints,
    poses: Floats,
    tables: Ints32,
    pool: Bytes,
    half: int,
    low: int,
    high: int,
    changed: Ints,
) -> None:
    """Classify cells anew.

    On each voxel the newest submap's word counts; where that is not decisive, older ones are added. A column
    is occupied if any voxel of the obstacle band is. Else it is free where the floor has been seen, or half
    of the band has been seen empty, as a planar lidar would have it; else unknown.

    Args:
        cells: (rows, cols) int8, changed in place.
        wanted: (rows, cols) bool: the cells to look at.
        corner: (2,) x, y of the lower left corner of these cells, metres, ``map`` frame.
        cell: side of a cell and of a voxel, metres.
        order: submaps, newest first.
        poses: (S, 3) of all submaps, ``map`` frame.
        tables: (S, B, B) numbers of their bricks, -1 where there is none.
        pool: (bricks, BRICK, BRICK, levels) int8 evidence.
        half: cells from a submap's corner to its centre.
        low: levels [0, low) are the floor.
        high: levels [low, high) are the obstacle band.
        changed: (4,) row0, col0, row1, col1: grows to hold every cell whose class changed.
    """
    total = np.empty(high, np.int32)
    side = tables.shape[1] * BRICK
    turns = np.column_stack((np.cos(poses[:, 2]), np.sin(poses[:, 2])))
    for row in range(cells.shape[0]):
        for col in range(cells.shape[1]):
            if not wanted[row, col]:
                continue
            x, y = corner[0] + (col + 0.5) * cell, corner[1] + (row + 0.5) * cell
            total[:] = 0
            for s in order:
                dx, dy = x - poses[s, 0], y - poses[s, 1]
                c = int(np.floor((turns[s, 0] * dx + turns[s, 1] * dy) / cell)) + half
                r = int(np.floor((-turns[s, 1] * dx + turns[s, 0] * dy) / cell)) + half
                if not (0 <= r < side and 0 <= c < side) or tables[s, r // BRICK, c // BRICK] < 0:
                    continue
                column = pool[tables[s, r // BRICK, c // BRICK], r % BRICK, c % BRICK]
                for z in range(high):
                    if abs(total[z]) < DECISIVE:
                        total[z] += column[z]
            state = _class_of(total, low, high)
            if cells[row, col] != state:
                cells[row, col] = state
                changed[0], changed[1] = min(changed[0], row), min(changed[1], col)
                changed[2], changed[3] = max(changed[2], row + 1), max(changed[3], col + 1)


@njit(cache=True)
def _class_of(total: Ints32, low: int, high: int) -> int:
    empty = 0
    for z in range(low, high):
        if total[z] > 0:
            return _OCCUPIED
        if total[z] < 0:
            empty += 1
    for z in range(low):
        if total[z] > 0:
            return _FREE
    return _FREE if empty >= _ENOUGH * (high - low) else _UNKNOWN
