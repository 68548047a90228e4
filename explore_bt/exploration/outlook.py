"""What can be seen from every place worth standing at, kept up to date as the map changes."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray

from explore_bt.exploration.kernel_input import read_only
from explore_bt.types import FREE, OCCUPIED, UNKNOWN

__all__ = ["Outlook", "Outlooks"]

_TURN = 2.0 * math.pi
_NOTHING = np.empty(0, dtype=np.int32)
_TILE = 4
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
    and column from the eye's, and the length of the ray in it.
    """
    count = int(_RAYS_PER_CELL * _TURN * reach)
    begin = np.zeros(count + 1, dtype=np.int64)
    size = count * (3 * int(reach) + 6)
    rows, cols = np.empty(size, dtype=np.int32), np.empty(size, dtype=np.int32)
    lengths = np.empty(size)
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
            rows[n], cols[n], lengths[n] = row, col, leave - entry
            n += 1
            entry = leave
            if next_col <= next_row:
                col += 1 if du > 0.0 else -1
                next_col += per_col
            else:
                row += 1 if dv > 0.0 else -1
                next_row += per_row
        begin[k + 1] = n
    return begin, rows[:n].copy(), cols[:n].copy(), lengths[:n].copy()


@njit(cache=True)
def _look(cells, eyes, depth, rays, ray_rows, ray_cols, lengths):  # type: ignore[no-untyped-def]  # numba kernel
    """Unknown cells in view of each of (N, 2) cells, as far as ``depth`` cells into the unknown.

    Also the tiles of 4 × 4 cells that its rays touch: nothing outside of these has a say.
    """
    rows, cols = cells.shape
    seen = np.full(rows * cols, -1, dtype=np.int32)
    begin = np.zeros(eyes.shape[0] + 1, dtype=np.int64)
    begin_tiles = begin.copy()
    out, tiles = np.empty(4096, dtype=np.int32), np.empty(4096, dtype=np.int32)
    wide = cols // _TILE + 1
    touched = np.full((rows // _TILE + 1) * wide, -1, dtype=np.int32)
    count, count_tiles = 0, 0
    for i in range(eyes.shape[0]):
        for k in range(rays.size - 1):
            passed = 0.0
            for j in range(rays[k], rays[k + 1]):
                row, col = eyes[i, 0] + ray_rows[j], eyes[i, 1] + ray_cols[j]
                if not (0 <= row < rows and 0 <= col < cols):
                    break
                tile = (row // _TILE) * wide + col // _TILE
                if touched[tile] != i:
                    touched[tile] = i
                    tiles = _appended(tiles, count_tiles, tile)
                    count_tiles += 1
                value = cells[row, col]
                if value == FREE:
                    continue
                if value == OCCUPIED or passed >= depth:
                    break
                passed += lengths[j]
                flat = row * cols + col
                if seen[flat] != i:
                    seen[flat] = i
                    out = _appended(out, count, flat)
                    count += 1
        begin[i + 1], begin_tiles[i + 1] = count, count_tiles
    return begin, out[:count].copy(), begin_tiles, tiles[:count_tiles].copy()


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
def _touched(begin, tiles, changed):  # type: ignore[no-untyped-def]  # numba kernel
    """Which places have a changed tile among those that their rays touch."""
    touched = np.zeros(begin.size - 1, dtype=np.bool_)
    for i in range(begin.size - 1):
        for k in range(begin[i], begin[i + 1]):
            if changed[tiles[k]]:
                touched[i] = True
                break
    return touched


@njit(cache=True)
def _changed_tiles(before, after):  # type: ignore[no-untyped-def]  # numba kernel
    rows, cols = after.shape
    wide = cols // _TILE + 1
    changed = np.zeros((rows // _TILE + 1) * wide, dtype=np.bool_)
    for row in range(rows):
        for col in range(cols):
            if before[row, col] != after[row, col]:
                changed[row // _TILE * wide + col // _TILE] = True
    return changed


def _joined(parts: list[NDArray[np.int32]]) -> Outlook:
    begin = np.zeros(len(parts) + 1, dtype=np.int64)
    np.cumsum([part.size for part in parts], out=begin[1:])
    return Outlook(begin, np.concatenate((_NOTHING, *parts)))


@dataclass(frozen=True, slots=True, eq=False)
class _Known:
    """What one place sees, and the tiles that this depends on."""

    cells: NDArray[np.int32]
    tiles: NDArray[np.int32]


class Outlooks:
    """Remembers what each place sees; looks again only where a ray of it met something that has changed."""

    def __init__(self) -> None:
        self._cells: NDArray[np.int8] = np.empty((0, 0), dtype=np.int8)
        self._first = (0, 0)
        self._known: dict[tuple[int, int], _Known] = {}
        self._rays: dict[float, tuple[NDArray[np.generic], ...]] = {}

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
        self._forget_changed(cells, first)
        keys = [(row, col) for row, col in places.tolist()]
        near_cells = np.full(len(keys), reach_cells) if near_cells is None else near_cells
        useful, frontier = np.zeros(len(keys), dtype=np.bool_), _frontier_blocks(read_only(cells))
        for cells_away in np.unique(near_cells):
            near = _within(frontier, cells_away)
            useful |= (near_cells == cells_away) & near[places[:, 0] // 8, places[:, 1] // 8]
        fresh = [i for i, key in enumerate(keys) if useful[i] and key not in self._known]
        if fresh:
            if reach_cells not in self._rays:
                self._rays = {reach_cells: _rays(reach_cells)}
            begin, seen, begin_tiles, tiles = _look(
                read_only(cells), read_only(places[fresh]), depth_cells, *self._rays[reach_cells]
            )
            for k, i in enumerate(fresh):
                self._known[keys[i]] = _Known(
                    seen[begin[k] : begin[k + 1]], tiles[begin_tiles[k] : begin_tiles[k + 1]]
                )
        return _joined([self._known[key].cells if useful[i] else _NOTHING for i, key in enumerate(keys)])

    def _forget_changed(self, cells: NDArray[np.int8], first: tuple[int, int]) -> None:
        before, self._cells = self._cells, cells
        if before.shape != cells.shape or first != self._first:
            self._known.clear()
            self._first = first
        elif self._known:
            changed = _changed_tiles(read_only(before), read_only(cells))
            tiles = _joined([known.tiles for known in self._known.values()])
            stale = _touched(tiles.begin, tiles.cells, changed)
            for key in [key for key, is_stale in zip(self._known, stale, strict=True) if is_stale]:
                del self._known[key]
