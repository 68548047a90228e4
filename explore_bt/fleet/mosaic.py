"""What one team mate has drawn, laid into one's own map."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from explore_bt.fleet.messages import Tile
from explore_bt.fleet.tiles import TILE_CELLS
from explore_bt.types import UNKNOWN, MapFit, Pose2

__all__ = ["Mosaic"]

Place = tuple[int, int]
_MOVED_M = 0.01
_MOVED_RAD = 0.002
_SPARE_M = 0.15


class Mosaic:
    """A mate's tiles, each as it was drawn, and where on one's own lattice they lie by the fit of the maps.

    A cell of one's own map is what the mate has at that cell's centre; the maps lie to each other as the fit
    has it about the tile of one's own map.

    Args:
        resolution_m: of both maps.
    """

    def __init__(self, resolution_m: float) -> None:
        self._resolution_m = resolution_m
        self._side_m = TILE_CELLS * resolution_m
        self._tiles: dict[Place, Tile] = {}
        self._fit: MapFit | None = None
        self._laid: dict[Place, Pose2] = {}
        self._revisions: dict[Place, int] = {}
        self._changed: set[Place] = set()
        within = (np.arange(TILE_CELLS) + 0.5) * resolution_m
        self._centres = np.stack(np.meshgrid(within, within), axis=-1).reshape(-1, 2)

    @property
    def places(self) -> set[Place]:
        """Tiles of one's own lattice on which there may be something; none without a fit."""
        return set(self._laid)

    def put(self, tile: Tile) -> bool:
        """Take a tile, unless there is a newer one; whether it was taken."""
        known = self._tiles.get(tile.place)
        if known is not None and known.revision >= tile.revision:
            return False
        self._tiles[tile.place] = tile
        if self._fit is None:
            return True
        under = self._under(tile.place, self._fit)
        self._revisions.update({place: max(self.revision(place), tile.revision) for place in under})
        self._laid.update({place: self._lies(place, self._fit) for place in under - self._laid.keys()})
        self._changed |= under
        return True

    def changed(self) -> set[Place]:
        """Tiles of one's own lattice that have to be drawn anew since the last call."""
        changed, self._changed = self._changed, set()
        return changed

    def lay(self, fit: MapFit | None) -> None:
        """The maps lie like this now; None: nobody knows."""
        if fit is self._fit:
            return
        before, was_laid = self.places, self._fit is not None
        self._fit = fit
        if fit is None:
            self._laid, self._revisions = {}, {}
            self._changed |= before
            return
        if was_laid and not any(_apart(T, self._lies(place, fit)) for place, T in self._laid.items()):
            return
        under: set[Place] = set()
        self._revisions = {}
        for tile in self._tiles.values():
            touched = self._under(tile.place, fit)
            self._revisions.update({place: max(self.revision(place), tile.revision) for place in touched})
            under |= touched
        self._laid = {place: self._lies(place, fit) for place in under}
        self._changed |= before | under

    def revision(self, place: Place) -> int:
        """Of the newest of the mate's tiles that touch a tile of one's own lattice; -1 for none."""
        return self._revisions.get(place, -1)

    def by(self, fit: MapFit) -> Mosaic:
        """The same tiles as they would lie by another fit."""
        if fit is self._fit:
            return self
        other = Mosaic(self._resolution_m)
        other._tiles = self._tiles
        other.lay(fit)
        return other

    def drawn(self, place: Place) -> NDArray[np.int8]:
        """(TILE_CELLS, TILE_CELLS) int8: a tile of one's own lattice as the mate has it."""
        shape = (TILE_CELLS, TILE_CELLS)
        T_ours_theirs = self._laid.get(place)
        if T_ours_theirs is None:
            return np.full(shape, UNKNOWN, dtype=np.int8)
        corner = np.array(place) * self._side_m
        there = T_ours_theirs.inverse().apply(self._centres + corner) / self._resolution_m
        cells = np.floor(there + 1e-6).astype(np.int64)
        low, high = cells.min(axis=0) // TILE_CELLS, cells.max(axis=0) // TILE_CELLS + 1
        source = self._joined((int(low[0]), int(low[1])), (int(high[0]), int(high[1])))
        inside = cells - low * TILE_CELLS
        return source[inside[:, 1], inside[:, 0]].reshape(shape)

    def _joined(self, low: Place, high: Place) -> NDArray[np.int8]:
        """The mate's tiles from one place up to, but not with, another; a tile's own cells if it is one."""
        side = TILE_CELLS
        rows, cols = high[1] - low[1], high[0] - low[0]
        only = self._tiles.get(low)
        if (rows, cols) == (1, 1) and only is not None:
            return only.cells
        joined = np.full((rows * side, cols * side), UNKNOWN, dtype=np.int8)
        for row in range(rows):
            for col in range(cols):
                tile = self._tiles.get((low[0] + col, low[1] + row))
                if tile is not None:
                    joined[row * side : (row + 1) * side, col * side : (col + 1) * side] = tile.cells
        return joined

    def _lies(self, place: Place, fit: MapFit) -> Pose2:
        return fit.at_ours(*self._middle(place))

    def _middle(self, place: Place) -> tuple[float, float]:
        return ((place[0] + 0.5) * self._side_m, (place[1] + 0.5) * self._side_m)

    def _under(self, tile: Place, fit: MapFit) -> set[Place]:
        """Tiles of one's own lattice that a mate's tile touches."""
        corners = (np.array([[0, 0], [1, 0], [1, 1], [0, 1]]) + tile) * self._side_m
        moved = fit.at_theirs(*self._middle(tile)).apply(corners)
        # without a turn or a shift a tile lies on a tile, and no neighbour has to be drawn
        spare_m = 0.0 if np.allclose(moved, corners, atol=1e-9) else _SPARE_M
        low = np.floor((moved.min(axis=0) - spare_m) / self._side_m + 1e-6).astype(int).tolist()
        high = np.ceil((moved.max(axis=0) + spare_m) / self._side_m - 1e-6).astype(int).tolist()
        return {(col, row) for col in range(low[0], high[0]) for row in range(low[1], high[1])}


def _apart(one: Pose2, other: Pose2) -> bool:
    return one.distance_to(other) > _MOVED_M or abs(math.remainder(one.yaw_rad - other.yaw_rad, math.tau)) > (
        _MOVED_RAD
    )
