"""What can be seen from every place worth standing at, kept up to date as the map changes."""

from __future__ import annotations

import math
from dataclasses import dataclass

import cv2
import numpy as np
from numba import njit
from numpy.typing import NDArray

from explore_bt.exploration.kernel_input import read_only
from explore_bt.types import FREE, OCCUPIED, UNKNOWN

__all__ = ["Outlook", "Outlooks"]

_TURN = 2.0 * math.pi
_NOTHING = np.empty(0, dtype=np.int32)
_TILE = 4
_TILE_RADIUS = 0.5 * math.sqrt(2.0) * _TILE
_RAYS_PER_CELL = 0.6


@dataclass(frozen=True, slots=True, eq=False)
class Outlook:
    """N places and the unknown cells in view of each, one place's after the other's.

    Attributes:
        begin: (N + 1,) int64, where the cells of a place begin in ``cells``.
        cells: (M,) int32, flat indices into the map that was looked at.
    """

    begin: NDArray[np.int64]
    cells: NDArray[np.int32]


@njit(cache=True)
def _appended(values, count, value):  # type: ignore[no-untyped-def]  # numba kernel
    if count == values.size:
        more = np.empty(2 * values.size, dtype=values.dtype)
        more[:count] = values
        values = more
    values[count] = value
    return values


@njit(cache=True)
def _rays(reach):  # type: ignore[no-untyped-def]  # numba kernel
    """Cells on every ray from a cell's middle; at the circle of reach rays are 1.7 cells apart.

    After Amanatides & Woo, 1987. All rays one after the other: where each begins, then for each cell its row
    and column from the eye's, how far from the eye the ray enters it, and the length of the ray in it.
    """
    count = int(_RAYS_PER_CELL * _TURN * reach)
    begin = np.zeros(count + 1, dtype=np.int64)
    size = count * (3 * int(reach) + 6)
    rows, cols = np.empty(size, dtype=np.int32), np.empty(size, dtype=np.int32)
    entries, lengths = np.empty(size), np.empty(size)
    n = 0
    for k in range(count):
        angle = _TURN * k / count
        du, dv = math.cos(angle), math.sin(angle)
        row, col = 0, 0
        per_row = abs(1.0 / dv) if dv != 0.0 else math.inf
        per_col = abs(1.0 / du) if du != 0.0 else math.inf
        next_row, next_col = 0.5 * per_row, 0.5 * per_col
        entry = 0.0
        while entry <= reach:
            leave = min(next_row, next_col)
            rows[n], cols[n], entries[n], lengths[n] = row, col, entry, leave - entry
            n += 1
            entry = leave
            if next_col <= next_row:
                col += 1 if du > 0.0 else -1
                next_col += per_col
            else:
                row += 1 if dv > 0.0 else -1
                next_row += per_row
        begin[k + 1] = n
    return begin, rows[:n].copy(), cols[:n].copy(), entries[:n].copy(), lengths[:n].copy()


@njit(cache=True)
def _look(cells, steps_free, eyes, depth, rays, ray_rows, ray_cols, entries, lengths):  # type: ignore[no-untyped-def]  # numba kernel
    """Unknown cells in view of each of (N, 2) cells, as far as ``depth`` cells into the unknown.

    A step along a ray changes row or column by one, so as many steps as ``steps_free`` says pass over free
    cells only. Also (N, rays) how far from the eye the last cell that had a say begins.
    """
    rows, cols = cells.shape
    seen = np.full(rows * cols, -1, dtype=np.int32)
    begin = np.zeros(eyes.shape[0] + 1, dtype=np.int64)
    ends = np.full((eyes.shape[0], rays.size - 1), np.inf, dtype=np.float32)
    out = np.empty(4096, dtype=np.int32)
    count = 0
    for i in range(eyes.shape[0]):
        for k in range(rays.size - 1):
            passed, j = 0.0, rays[k]
            while j < rays[k + 1]:
                row, col = eyes[i, 0] + ray_rows[j], eyes[i, 1] + ray_cols[j]
                outside = not (0 <= row < rows and 0 <= col < cols)
                if not outside and cells[row, col] == FREE:
                    j += steps_free[row, col]
                    continue
                if outside or cells[row, col] == OCCUPIED or passed >= depth:
                    ends[i, k] = entries[j]
                    break
                passed += lengths[j]
                j += 1
                flat = row * cols + col
                if seen[flat] != i:
                    seen[flat] = i
                    out = _appended(out, count, flat)
                    count += 1
        begin[i + 1] = count
    return begin, out[:count].copy(), ends


@njit(cache=True)
def _cones(reach):  # type: ignore[no-untyped-def]  # numba kernel
    """For every tile of 4 × 4 cells round an eye: first and last ray that may meet it, and how far off it is.

    By row and column of its first cell from the eye's, plus reach and 4. The circle about the tile stands for
    it; one that holds the eye has all rays.
    """
    count = int(_RAYS_PER_CELL * _TURN * reach)
    span = int(reach) + _TILE
    first = np.zeros((2 * span + 1, 2 * span + 1), dtype=np.int32)
    last, near = np.full_like(first, count - 1), np.zeros(first.shape, dtype=np.float32)
    for row in range(-span, span + 1):
        for col in range(-span, span + 1):
            y, x = row + 0.5 * (_TILE - 1), col + 0.5 * (_TILE - 1)
            away = math.hypot(x, y)
            if away > _TILE_RADIUS:
                middle, half = math.atan2(y, x) % _TURN, math.asin(_TILE_RADIUS / away)
                first[row + span, col + span] = math.floor((middle - half) / _TURN * count)
                last[row + span, col + span] = math.ceil((middle + half) / _TURN * count)
                near[row + span, col + span] = away - _TILE_RADIUS - 0.01
    return first, last, near


@njit(cache=True)
def _may_meet(eyes, ends, tiles, reach, first, last, near):  # type: ignore[no-untyped-def]  # numba kernel
    """Which of (N, 2) eyes have a ray that may come to one of (M, 2) tiles."""
    span, count = int(reach) + _TILE, ends.shape[1]
    meets = np.zeros(eyes.shape[0], dtype=np.bool_)
    for i in range(eyes.shape[0]):
        for t in range(tiles.shape[0]):
            row, col = _TILE * tiles[t, 0] - eyes[i, 0] + span, _TILE * tiles[t, 1] - eyes[i, 1] + span
            if not (0 <= row <= 2 * span and 0 <= col <= 2 * span) or near[row, col] > reach:
                continue
            for k in range(first[row, col], last[row, col] + 1):
                if ends[i, k % count] >= near[row, col]:
                    meets[i] = True
                    break
            if meets[i]:
                break
    return meets


@njit(cache=True)
def _frontier_blocks(cells):  # type: ignore[no-untyped-def]  # numba kernel
    """Blocks of 8 × 8 cells that have a free cell beside an unknown one, as a mask."""
    rows, cols = cells.shape
    high, wide = rows // 8 + 1, cols // 8 + 1
    at = np.zeros((high, wide), dtype=np.bool_)
    for row in range(rows):
        for col in range(cols):
            if cells[row, col] != FREE:
                continue
            if (
                (row > 0 and cells[row - 1, col] == UNKNOWN)
                or (row + 1 < rows and cells[row + 1, col] == UNKNOWN)
                or (col > 0 and cells[row, col - 1] == UNKNOWN)
                or (col + 1 < cols and cells[row, col + 1] == UNKNOWN)
            ):
                at[row // 8, col // 8] = True
    return at


@njit(cache=True)
def _within(at, reach):  # type: ignore[no-untyped-def]  # numba kernel
    """Blocks with a marked one within reach, which counts in cells."""
    high, wide = at.shape
    near = np.zeros((high, wide), dtype=np.bool_)
    span = int(reach) // 8 + 1
    for row in range(high):
        for col in range(wide):
            if at[row, col]:
                near[max(0, row - span) : row + span + 1, max(0, col - span) : col + span + 1] = True
    return near


@njit(cache=True)
def _changed_tiles(before, after):  # type: ignore[no-untyped-def]  # numba kernel
    """Tiles of 4 × 4 cells with a cell that differs, as a mask."""
    rows, cols = after.shape
    changed = np.zeros((rows // _TILE + 1, cols // _TILE + 1), dtype=np.bool_)
    for row in range(rows):
        for col in range(cols):
            if before[row, col] != after[row, col]:
                changed[row // _TILE, col // _TILE] = True
    return changed


def _joined(parts: list[NDArray[np.int32]]) -> Outlook:
    begin = np.zeros(len(parts) + 1, dtype=np.int64)
    np.cumsum([part.size for part in parts], out=begin[1:])
    return Outlook(begin, np.concatenate((_NOTHING, *parts)))


@dataclass(frozen=True, slots=True, eq=False)
class _Known:
    """What one place sees, and how far along each ray the map has a say in that."""

    cells: NDArray[np.int32]
    ends: NDArray[np.float32]


@dataclass(frozen=True, slots=True)
class _Rays:
    """What depends on the lidar's reach alone."""

    reach: float
    steps: tuple[NDArray[np.generic], ...]
    cones: tuple[NDArray[np.generic], ...]


class Outlooks:
    """Remembers what each place sees; looks again only where a ray of it may have met what has changed."""

    def __init__(self) -> None:
        self._cells: NDArray[np.int8] = np.empty((0, 0), dtype=np.int8)
        self._first = (0, 0)
        self._known: dict[tuple[int, int], _Known] = {}
        self._rays: _Rays | None = None

    def look(
        self,
        cells: NDArray[np.int8],
        places: NDArray[np.int64],
        reach_cells: float,
        depth_cells: float,
        *,
        first: tuple[int, int] = (0, 0),
        near_cells: NDArray[np.float64] | None = None,
    ) -> Outlook:
        """The unknown cells in view of each place; none of places with no frontier near.

        Args:
            cells: (rows, cols) int8, the map.
            places: (N, 2) int64 rows and columns of free cells.
            reach_cells: the lidar's range; the same in every call.
            depth_cells: a ray ends after so many cells of unknown; the same in every call.
            first: the map's first cell on a lattice that does not move when the map grows.
            near_cells: (N,) how near a frontier has to be to each place; the lidar's range by default.
        """
        rays = self._rays_of(reach_cells)
        self._forget_changed(cells, first, rays)
        keys = [(row, col) for row, col in places.tolist()]
        near_cells = np.full(len(keys), reach_cells) if near_cells is None else near_cells
        useful, frontier = np.zeros(len(keys), dtype=np.bool_), _frontier_blocks(read_only(cells))
        for cells_away in np.unique(near_cells):
            near = _within(frontier, cells_away)
            useful |= (near_cells == cells_away) & near[places[:, 0] // 8, places[:, 1] // 8]
        fresh = [i for i, key in enumerate(keys) if useful[i] and key not in self._known]
        if fresh:
            begin, seen, ends = _look(
                read_only(cells), _steps_free(cells), read_only(places[fresh]), depth_cells, *rays.steps
            )
            for k, i in enumerate(fresh):
                self._known[keys[i]] = _Known(seen[begin[k] : begin[k + 1]], ends[k])
        return _joined([self._known[key].cells if useful[i] else _NOTHING for i, key in enumerate(keys)])

    def _rays_of(self, reach: float) -> _Rays:
        if self._rays is None or self._rays.reach != reach:
            self._rays = _Rays(reach, _rays(reach), _cones(reach))
        return self._rays

    def _forget_changed(self, cells: NDArray[np.int8], first: tuple[int, int], rays: _Rays) -> None:
        before, self._cells = self._cells, cells
        if before.shape != cells.shape or first != self._first:
            self._known.clear()
            self._first = first
            return
        tiles = np.ascontiguousarray(np.argwhere(_changed_tiles(read_only(before), read_only(cells))))
        if not len(tiles):
            return
        low, high = _TILE * tiles.min(axis=0) - rays.reach, _TILE * (tiles.max(axis=0) + 1) + rays.reach
        near = [key for key in self._known if low[0] <= key[0] <= high[0] and low[1] <= key[1] <= high[1]]
        if near:
            ends = np.array([self._known[key].ends for key in near])
            stale = _may_meet(np.array(near), ends, tiles, rays.reach, *rays.cones)
            for key in [key for key, is_stale in zip(near, stale, strict=True) if is_stale]:
                del self._known[key]


def _steps_free(cells: NDArray[np.int8]) -> NDArray[np.uint8]:
    """Rows and columns together to the nearest cell that is not free, or to the map's edge; 255 at most."""
    free = np.pad((cells == FREE).view(np.uint8), 1)
    return cv2.distanceTransform(free, cv2.DIST_L1, 3, dstType=cv2.CV_8U)[1:-1, 1:-1].copy()
