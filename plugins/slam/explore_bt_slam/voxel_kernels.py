"""Rays through voxels: one sweep is traced into a scratch box, then taken into the bricks of a submap.

Evidence is int8 tenths of log-odds; 0 is unknown and no other value's sum: it is stepped over.
"""

from __future__ import annotations

from typing import TypeAlias

import numpy as np
from numba import njit
from numpy.typing import NDArray

from explore_bt_slam.arrays import Bools, Bytes, Floats, Ints32, Singles
from explore_bt_slam.log_odds import CLEAREST, HIT, MISS, SOLIDEST

__all__ = ["BRICK", "DECISIVE", "allocate", "take_in", "trace"]

BRICK = 16
"""Columns along the side of a brick, the unit of memory."""
DECISIVE = 9
"""Evidence that a voxel's state rests on alone: one hit, or three sweeps that looked through it."""

_HIT, _MISS = round(10 * HIT), round(10 * MISS)
_SOLIDEST, _CLEAREST = round(10 * SOLIDEST), round(10 * CLEAREST)
_PASSED, _STRUCK = 1, 2
_UPRIGHT_M = 0.3
_LYING_M = 0.5

Marks: TypeAlias = NDArray[np.uint8]


@njit(cache=True)
def trace(
    origins: Singles,
    ends: Singles,
    pose: Floats,
    corner: Floats,
    cell: float,
    depth: float,
    scratch: Marks,
    touched: Bools,
) -> None:
    """Mark what one sweep struck and what it looked through; a struck voxel stays struck.

    A return with no other just above or below it lies on something level, a table top or the floor. A flat
    ray runs along under or over such a surface inside its own voxels before it meets it, and would clear
    them: so it marks nothing on its last level over its last half metre.

    Rays with the same end voxel count once. They are walked after Amanatides and Woo (1987) and stop short
    of their last voxel.

    Args:
        origins: (N, 3) metres, level base axes, z from the floor: where the rays begin.
        ends: (N, 3) where they ended.
        pose: (3,) of the base in the scratch box's axes: x, y, yaw.
        corner: (3,) of the box, metres, same axes.
        cell: side of a voxel, metres.
        depth: how far behind its return a ray ends, metres.
        scratch: (rows, cols, levels) uint8, zeros: 1 is looked through, 2 is struck.
        touched: (rows, cols) bool, False: columns with any mark.
    """
    count = ends.shape[0]
    tips, starts = np.empty((count, 3)), np.empty((count, 3))
    cos, sin = np.cos(pose[2]), np.sin(pose[2])
    n = 0
    for i in range(count):
        dx, dy, dz = ends[i, 0] - origins[i, 0], ends[i, 1] - origins[i, 1], ends[i, 2] - origins[i, 2]
        on = depth / max(np.sqrt(dx * dx + dy * dy + dz * dz), 1e-6)
        x, y, z = ends[i, 0] + on * dx, ends[i, 1] + on * dy, ends[i, 2] + on * dz
        tips[n, 0] = (pose[0] + cos * x - sin * y - corner[0]) / cell
        tips[n, 1] = (pose[1] + sin * x + cos * y - corner[1]) / cell
        tips[n, 2] = (z - corner[2]) / cell
        x, y = origins[i, 0], origins[i, 1]
        starts[n, 0] = (pose[0] + cos * x - sin * y - corner[0]) / cell
        starts[n, 1] = (pose[1] + sin * x + cos * y - corner[1]) / cell
        starts[n, 2] = (origins[i, 2] - corner[2]) / cell
        col, row, level = int(np.floor(tips[n, 0])), int(np.floor(tips[n, 1])), int(np.floor(tips[n, 2]))
        inside = 0 <= row < scratch.shape[0] and 0 <= col < scratch.shape[1]
        if inside and 0 <= level < scratch.shape[2]:
            if scratch[row, col, level] == _STRUCK:
                continue
            scratch[row, col, level] = _STRUCK
            touched[row, col] = True
        n += 1
    for i in range(n):
        guarded = _LYING_M / cell if _is_lone(tips[i], scratch, round(_UPRIGHT_M / cell)) else 0.0
        _walk(starts[i], tips[i], guarded, scratch, touched)


@njit(cache=True)
def _is_lone(tip: Floats, scratch: Marks, reach: int) -> bool:
    """Whether nothing else of the sweep was struck a little above or below."""
    col, row, level = int(np.floor(tip[0])), int(np.floor(tip[1])), int(np.floor(tip[2]))
    if not (0 <= row < scratch.shape[0] and 0 <= col < scratch.shape[1]):
        return False
    for other in range(max(level - reach, 0), min(level + reach + 1, scratch.shape[2])):
        if other != level and scratch[row, col, other] == _STRUCK:
            return False
    return True


@njit(cache=True)
def _walk(start: Floats, tip: Floats, guarded: float, scratch: Marks, touched: Bools) -> None:
    """Mark every voxel that a ray enters, but the last; units are voxels.

    On the last one's level none is marked over the last ``guarded`` voxels of the way.
    """
    rows, cols, levels = scratch.shape
    col, row, level = int(np.floor(start[0])), int(np.floor(start[1])), int(np.floor(start[2]))
    col_end, row_end, level_end = int(np.floor(tip[0])), int(np.floor(tip[1])), int(np.floor(tip[2]))
    dx, dy, dz = tip[0] - start[0], tip[1] - start[1], tip[2] - start[2]
    step_x, step_y, step_z = (1 if dx > 0.0 else -1), (1 if dy > 0.0 else -1), (1 if dz > 0.0 else -1)
    next_x = ((col + (step_x > 0)) - start[0]) / dx if dx != 0.0 else np.inf
    next_y = ((row + (step_y > 0)) - start[1]) / dy if dy != 0.0 else np.inf
    next_z = ((level + (step_z > 0)) - start[2]) / dz if dz != 0.0 else np.inf
    per_x = 1.0 / abs(dx) if dx != 0.0 else np.inf
    per_y = 1.0 / abs(dy) if dy != 0.0 else np.inf
    per_z = 1.0 / abs(dz) if dz != 0.0 else np.inf
    # share of the way after which the level of the end is guarded
    guard = 1.0 - guarded / max(np.sqrt(dx * dx + dy * dy + dz * dz), 1e-6)
    entered = 0.0
    for _ in range(abs(col_end - col) + abs(row_end - row) + abs(level_end - level)):
        inside = (
            (level != level_end or entered < guard)
            and 0 <= row < rows
            and 0 <= col < cols
            and 0 <= level < levels
        )
        if inside and scratch[row, col, level] == 0:
            scratch[row, col, level] = _PASSED
            touched[row, col] = True
        # along an axis that is done, rounding must not step again
        along_x = next_x if col != col_end else np.inf
        along_y = next_y if row != row_end else np.inf
        along_z = next_z if level != level_end else np.inf
        entered = min(along_x, along_y, along_z)
        if along_x <= along_y and along_x <= along_z:
            col += step_x
            next_x += per_x
        elif along_y <= along_z:
            row += step_y
            next_y += per_y
        else:
            level += step_z
            next_z += per_z


@njit(cache=True)
def allocate(touched: Bools, row0: int, col0: int, table: Ints32, used: int) -> int:
    """Give every brick under a touched column a number; ``row0``, ``col0`` place the box in the submap.

    Returns:
        How many bricks are in use now.
    """
    for row in range(touched.shape[0]):
        for col in range(touched.shape[1]):
            if touched[row, col]:
                r, c = (row + row0) // BRICK, (col + col0) // BRICK
                if table[r, c] < 0:
                    table[r, c] = used
                    used += 1
    return used


@njit(cache=True)
def take_in(
    scratch: Marks, touched: Bools, row0: int, col0: int, table: Ints32, pool: Bytes, dirty: Bools
) -> None:
    """Teach the bricks what the scratch box says, and blank the box.

    Args:
        scratch: see ``trace``; zeros afterwards.
        touched: see ``trace``; False afterwards.
        row0: of the box in the submap.
        col0: the same.
        table: (B, B) int32 number of each brick.
        pool: (bricks, BRICK, BRICK, levels) int8 evidence, changed in place.
        dirty: (rows, cols) bool of the box: columns in which a voxel's state changed.
    """
    for row in range(touched.shape[0]):
        for col in range(touched.shape[1]):
            dirty[row, col] = False
            if not touched[row, col]:
                continue
            touched[row, col] = False
            r, c = row + row0, col + col0
            column = pool[table[r // BRICK, c // BRICK], r % BRICK, c % BRICK]
            for level in range(scratch.shape[2]):
                mark = scratch[row, col, level]
                if mark == 0:
                    continue
                scratch[row, col, level] = 0
                before = int(column[level])
                after = min(max(before + (_HIT if mark == _STRUCK else _MISS), _CLEAREST), _SOLIDEST)
                if after == 0:
                    after = 1 if mark == _STRUCK else -1
                column[level] = after
                if _state(before) != _state(after):
                    dirty[row, col] = True


@njit(cache=True)
def _state(evidence: int) -> int:
    """Which side of unknown, and whether decisively."""
    if evidence >= DECISIVE or evidence <= -DECISIVE:
        return 2 if evidence > 0 else -2
    return 1 if evidence > 0 else (-1 if evidence < 0 else 0)
