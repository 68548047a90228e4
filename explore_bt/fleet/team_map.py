"""A robot's own map, completed by what its team has seen."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from explore_bt.fleet.messages import Tile
from explore_bt.fleet.mosaic import Mosaic
from explore_bt.fleet.tiles import TILE_CELLS, TileCutter, first_cell
from explore_bt.types import UNKNOWN, GridWindow, MapFit, OccupancyGrid

__all__ = ["TeamMap", "merged_map"]

_REMEMBERED = 64


class _Maps(Protocol):
    """The part of SLAM that is asked for."""

    def grid(self) -> OccupancyGrid:
        """The newest map."""

    def changed_since(self, revision: int) -> GridWindow | None:
        """Where it may differ from that revision."""


class TeamMap:
    """What the robot has seen itself counts; where it has seen nothing, the newest tile of anyone does.

    So around the robot the map agrees with its own scans, and the seam to what others drew, which is off by
    the error of both maps, lies where the robot has never looked. The cost of a change is that of its window,
    and of a copy of the cells.
    """

    def __init__(self, own: _Maps) -> None:
        self._maps = own
        self._mosaics: dict[str, Mosaic] = {}
        self._stale: set[tuple[int, int]] = set()
        self._own: OccupancyGrid | None = None
        self._grid: OccupancyGrid | None = None
        self._theirs = np.empty((0, 0), dtype=np.int8)
        self._changes: deque[tuple[int, GridWindow]] = deque(maxlen=_REMEMBERED)
        self._revision = 0

    def put(self, sender: str, tile: Tile) -> bool:
        """Keep a tile, in the sender's ``map`` frame, unless there is a newer one; whether it is kept.

        One with cells of another size is not. It is drawn once ``lay`` has told how the sender's map lies.
        """
        resolution_m = self._maps.grid().resolution_m
        if len(tile.cells) != TILE_CELLS or abs(tile.resolution_m - resolution_m) > 1e-4:
            return False
        mosaic = self._mosaics.setdefault(sender, Mosaic(resolution_m))
        is_taken = mosaic.put(tile)
        self._stale |= mosaic.changed()
        return is_taken

    def lay(self, sender: str, fit: MapFit | None) -> None:
        """The sender's map lies like this in one's own; None: it is not to be drawn."""
        if sender not in self._mosaics:
            self._mosaics[sender] = Mosaic(self._maps.grid().resolution_m)
        self._mosaics[sender].lay(fit)
        self._stale |= self._mosaics[sender].changed()

    def seen_by(self, sender: str, fit: MapFit) -> Mosaic | None:
        """The sender's map as it would lie by a fit; None if it has told nothing."""
        mosaic = self._mosaics.get(sender)
        return None if mosaic is None else mosaic.by(fit)

    def grid(self) -> OccupancyGrid:
        """The newest map; the same object as before while nothing has changed. Alone: the own map itself."""
        own = self._maps.grid()
        if self._grid is None and not self._places():
            self._stale.clear()
            return own
        if self._grid is None or self._own is None or not self._fits(own):
            self._draw_anew(own)
        elif own is not self._own or self._stale:
            self._draw_changes(own)
        assert self._grid is not None  # drawn by now
        return self._grid

    def changed_since(self, revision: int) -> GridWindow | None:
        """As ``Slam.changed_since``, of this map."""
        if self._grid is None:
            return self._maps.changed_since(revision)
        later = [window for of, window in self._changes if of > revision]
        known_from = self._changes[0][0] - 1 if self._changes else self._revision
        if revision < known_from or self._grid is None or revision > self._revision:
            return None
        joined = GridWindow(0, 0, 0, 0)
        for window in later:
            joined = joined.joined(window)
        return joined

    def _fits(self, own: OccupancyGrid) -> bool:
        """Whether the own map and all tiles lie within what is drawn, on the same lattice."""
        assert self._grid is not None
        whole = _window_of(own, self._grid)
        spans = [whole, *(self._tile_window(place) for place in self._stale)]
        rows, cols = self._grid.shape
        is_inside = all(w.row0 >= 0 and w.col0 >= 0 and w.row1 <= rows and w.col1 <= cols for w in spans)
        return is_inside and self._grid.resolution_m == own.resolution_m

    def _draw_anew(self, own: OccupancyGrid) -> None:
        """On an extent of whole tiles with one to spare on every side, so that it seldom grows."""
        col0, row0 = first_cell(own)
        places = np.array(
            [
                *self._places(),
                (col0 // TILE_CELLS, row0 // TILE_CELLS),
                ((col0 + own.shape[1]) // TILE_CELLS, (row0 + own.shape[0]) // TILE_CELLS),
            ]
        )
        (left, low), (right, high) = places.min(axis=0) - 1, places.max(axis=0) + 2
        shape = (int(high - low) * TILE_CELLS, int(right - left) * TILE_CELLS)
        (x, y), size = own.origin_xy, own.resolution_m
        origin = (x + float(left * TILE_CELLS - col0) * size, y + float(low * TILE_CELLS - row0) * size)
        self._theirs = np.full(shape, UNKNOWN, dtype=np.int8)
        self._revision += 1
        self._grid = OccupancyGrid(self._theirs.copy(), own.resolution_m, origin, self._revision)
        self._changes.clear()
        self._stale.clear()
        for place in self._places():
            self._draw_tile(place)
        self._finish(own, GridWindow(0, 0, *shape))
        self._changes.clear()

    def _draw_changes(self, own: OccupancyGrid) -> None:
        assert self._own is not None
        window = GridWindow(0, 0, 0, 0)
        if own is not self._own:
            changed = self._maps.changed_since(self._own.revision)
            assert self._grid is not None
            whole = _window_of(own, self._grid)
            is_same = own.origin_xy == self._own.origin_xy and own.shape == self._own.shape
            known = changed if is_same else None
            window = whole if known is None else known.moved(whole.row0, whole.col0)
        for place in self._stale:
            window = window.joined(self._draw_tile(place))
        self._stale.clear()
        self._finish(own, window)

    def _draw_tile(self, place: tuple[int, int]) -> GridWindow:
        """What the others have seen of one tile, the newest last."""
        window = self._tile_window(place)
        part = self._theirs[window.slices]
        part[:] = UNKNOWN
        for mosaic in sorted(self._mosaics.values(), key=lambda mosaic: mosaic.revision(place)):
            cells = mosaic.drawn(place)
            np.copyto(part, cells, where=cells != UNKNOWN)
        return window

    def _places(self) -> set[tuple[int, int]]:
        """All tiles on which others have drawn."""
        return {place for mosaic in self._mosaics.values() for place in mosaic.places}

    def _tile_window(self, place: tuple[int, int]) -> GridWindow:
        assert self._grid is not None
        col0, row0 = first_cell(self._grid)
        row, col = place[1] * TILE_CELLS - row0, place[0] * TILE_CELLS - col0
        return GridWindow(row, col, row + TILE_CELLS, col + TILE_CELLS)

    def _finish(self, own: OccupancyGrid, window: GridWindow) -> None:
        """Lay the own map over the others' within a window."""
        assert self._grid is not None
        self._own = own
        if window.is_empty:
            return
        cells = self._grid.cells.copy()
        cells[window.slices] = self._theirs[window.slices]
        _lay_over(cells, own, _window_of(own, self._grid), window)
        self._revision += 1
        self._changes.append((self._revision, window))
        grid = self._grid
        self._grid = OccupancyGrid(cells, grid.resolution_m, grid.origin_xy, self._revision)


def _window_of(own: OccupancyGrid, drawn: OccupancyGrid) -> GridWindow:
    """Where a map lies in a larger one."""
    (col, row), (col0, row0) = first_cell(own), first_cell(drawn)
    return GridWindow(row - row0, col - col0, row - row0 + own.shape[0], col - col0 + own.shape[1])


def _lay_over(cells: NDArray[np.int8], own: OccupancyGrid, at: GridWindow, window: GridWindow) -> None:
    row0, col0 = max(at.row0, window.row0), max(at.col0, window.col0)
    row1, col1 = min(at.row1, window.row1), min(at.col1, window.col1)
    if row0 >= row1 or col0 >= col1:
        return
    known = own.cells[row0 - at.row0 : row1 - at.row0, col0 - at.col0 : col1 - at.col0]
    np.copyto(cells[row0:row1, col0:col1], known, where=known != UNKNOWN)


def merged_map(first: _Maps, others: Sequence[tuple[_Maps, MapFit | None]]) -> OccupancyGrid:
    """The maps of several robots as one: where two have seen the same, the earlier one's.

    Args:
        first: in whose ``map`` frame it is drawn.
        others: with how they lie in it; who does not is left out.
    """
    whole = TeamMap(first)
    for number, (other, fit) in enumerate(others):
        whole.lay(str(number), fit)
        for tile in TileCutter().changed(other.grid(), None, len(others) - number):
            whole.put(str(number), tile)
    return whole.grid()
