"""The terrains of the map planned on last, brought up to date instead of made anew."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from explore_bt.types import UNKNOWN, GridWindow, OccupancyGrid
from explore_bt_planners.feature_transform import FeatureTransform, feature_transform
from explore_bt_planners.terrain import Terrain
from explore_bt_planners.transform_update import changed_window, grown, paste, update_transform

__all__ = ["TerrainCache"]

_ANOTHER_MAP = 0.3  # share of the cells: who differs in more is no later state of the same map
_LATTICE = 1e-3  # cells by which the corner of a map may miss the other's cells


class TerrainCache:
    """One map's transform and its terrains for several widths, for one thread at a time.

    A map given later is compared with the one before, cell by cell, unless somebody who knows has said
    where they differ; so it does not matter where a map comes from, and none is taken for another. A
    terrain is good until the next call.

    Attributes:
        lineage: grows when a map comes that is no later state of the one before.
    """

    def __init__(self, separation: float, size: int = 4) -> None:
        self.lineage = 0
        self._separation = separation
        self._size = size
        self._grid: OccupancyGrid | None = None
        self._transform: FeatureTransform | None = None
        self._terrains: tuple[Terrain, ...] = ()
        self._hint: tuple[OccupancyGrid, OccupancyGrid, GridWindow] | None = None

    def expect(self, before: OccupancyGrid, now: OccupancyGrid, window: GridWindow) -> None:
        """Take somebody's word that two maps of one shape and place differ only within a window."""
        self._hint = (before, now, window)

    def terrain(self, grid: OccupancyGrid, threshold_m: float) -> Terrain:
        """The terrain of this map for this threshold."""
        transform = self._transform_of(grid)
        terrain = next((each for each in self._terrains if each.threshold_m == threshold_m), None)
        if terrain is None:
            terrain = Terrain(grid, threshold_m, self._separation, transform)
        others = tuple(each for each in self._terrains if each is not terrain)
        self._terrains = (terrain, *others[: self._size - 1])
        terrain.catch_up(grid)
        return terrain

    def _transform_of(self, grid: OccupancyGrid) -> FeatureTransform:
        before, self._grid = self._grid, None  # should this be broken off, nothing half done is used
        if self._transform is None or before is None or not self._is_later(before, grid):
            self._transform, self._terrains = feature_transform(np.ascontiguousarray(grid.cells)), ()
            self.lineage += 1
        self._grid = grid
        return self._transform

    def _is_later(self, before: OccupancyGrid, grid: OccupancyGrid) -> bool:
        """Bring all up to date with ``grid`` if that is worth it; whether it was."""
        if before is grid or _is_same_map(before, grid):
            return True
        offset = _offset(before, grid)
        if offset is None:
            return False
        old = before.cells
        if before.shape != grid.shape:
            old = paste(np.full(grid.shape, UNKNOWN, dtype=np.int8), old, offset)
        changed, count = changed_window(old, np.ascontiguousarray(grid.cells), self._where(before, grid))
        if count > _ANOTHER_MAP * grid.cells.size:
            return False
        if before.shape != grid.shape:
            self._grow(grid.shape, offset)
        if count:
            self._update(grid.cells, changed)
        return True

    def _where(self, before: OccupancyGrid, grid: OccupancyGrid) -> GridWindow:
        hint, self._hint = self._hint, None
        if hint and hint[0] is before and hint[1] is grid and before.shape == grid.shape:
            return hint[2]
        return GridWindow(0, 0, *grid.shape)

    def _grow(self, shape: tuple[int, int], offset: tuple[int, int]) -> None:
        assert self._transform is not None
        self._transform = grown(self._transform, shape, offset)
        for terrain in self._terrains:
            terrain.grow(self._transform, offset)

    def _update(self, cells: NDArray[np.int8], changed: GridWindow) -> None:
        assert self._transform is not None
        window = update_transform(self._transform, np.ascontiguousarray(cells), changed)
        for terrain in self._terrains:
            terrain.fall_behind(window)


def _offset(before: OccupancyGrid, grid: OccupancyGrid) -> tuple[int, int] | None:
    """Row and column in ``grid`` of the first cell of ``before``; None if it does not hold all of that."""
    if before.resolution_m != grid.resolution_m:
        return None
    apart = (np.asarray(before.origin_xy) - np.asarray(grid.origin_xy)) / grid.resolution_m
    col, row = (round(float(each)) for each in apart)
    fits = 0 <= row <= grid.shape[0] - before.shape[0] and 0 <= col <= grid.shape[1] - before.shape[1]
    return (row, col) if fits and np.abs(apart - (col, row)).max() < _LATTICE else None


def _is_same_map(one: OccupancyGrid, other: OccupancyGrid) -> bool:
    return (
        one.cells is other.cells
        and one.resolution_m == other.resolution_m
        and one.origin_xy == other.origin_xy
    )
