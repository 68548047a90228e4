"""What the planners derive from one map for one width of robot."""

from __future__ import annotations

import math
from functools import cached_property
from threading import Lock

import cv2
import numpy as np
from numpy.typing import NDArray

from explore_bt.types import OccupancyGrid
from explore_bt_planners.feature_transform import FeatureTransform, feature_transform
from explore_bt_planners.medial_axis import medial_axis

__all__ = ["SLACK_M", "Terrain", "TerrainCache"]

SLACK_M = 1e-6
"""Rounding allowed for in comparisons of clearances, metres."""


class Terrain:
    """One map as a robot of one width sees it; every field is computed at most once.

    Attributes:
        threshold_m: clearance that a cell needs to be passable.
    """

    def __init__(
        self, grid: OccupancyGrid, threshold_m: float, separation: float, transform: FeatureTransform
    ) -> None:
        self.grid = grid
        self.threshold_m = threshold_m
        self.transform = transform
        self._separation = separation
        cells = max(0.0, (threshold_m - SLACK_M) / grid.resolution_m + 0.5)
        self.min_squared = max(1, math.ceil(cells * cells))

    @cached_property
    def clearance_m(self) -> NDArray[np.float32]:
        """(rows, cols) float32, metres; equal to ``explore_bt.exploration.clearance_field``."""
        field = np.sqrt(self.transform.squared, dtype=np.float32)
        field -= np.float32(0.5)
        np.maximum(field, 0.0, out=field)
        field *= np.float32(self.grid.resolution_m)
        return field

    @cached_property
    def passable(self) -> NDArray[np.bool_]:
        """(rows, cols) bool: cells whose centre is clear enough for the robot's."""
        return self.transform.squared >= self.min_squared

    @cached_property
    def skeleton(self) -> NDArray[np.bool_]:
        """(rows, cols) bool: the medial axis of the passable space."""
        separation = self._separation * self.threshold_m / self.grid.resolution_m
        return medial_axis(self.transform, self.min_squared, separation)

    @cached_property
    def component(self) -> NDArray[np.int32]:
        """(rows, cols) int32: label of the connected piece of passable space, 0 outside of it.

        A diagonal step needs both cells beside it, so pieces are joined through edges only.
        """
        _, labels = cv2.connectedComponents(self.passable.view(np.uint8), connectivity=4, ltype=cv2.CV_32S)
        return np.asarray(labels, dtype=np.int32)

    def to_cells(self, x: float, y: float) -> tuple[float, float]:
        """(column, row) as real numbers: cell (row, col) is the square [col, col+1) × [row, row+1)."""
        ox, oy = self.grid.origin_xy
        return ((x - ox) / self.grid.resolution_m, (y - oy) / self.grid.resolution_m)

    def to_metres(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """(N, 2) x, y in the ``map`` frame of (N, 2) columns and rows as real numbers."""
        return points * self.grid.resolution_m + np.asarray(self.grid.origin_xy)


class TerrainCache:
    """The terrains planned on last, so that several plans on one map cost one transform.

    A map is known by its array of cells, which is frozen and kept alive here.
    """

    def __init__(self, separation: float, size: int = 2) -> None:
        self._separation = separation
        self._size = size
        self._entries: tuple[Terrain, ...] = ()
        self._lock = Lock()

    def terrain(self, grid: OccupancyGrid, threshold_m: float) -> Terrain:
        """The terrain of this map for this threshold."""
        with self._lock:
            twin: Terrain | None = None
            for entry in self._entries:
                if not _same_map(entry.grid, grid):
                    continue
                if entry.threshold_m == threshold_m:
                    return entry
                twin = entry
            transform = twin.transform if twin else feature_transform(np.ascontiguousarray(grid.cells))
            fresh = Terrain(grid, threshold_m, self._separation, transform)
            self._entries = (fresh, *self._entries[: self._size - 1])
            return fresh


def _same_map(one: OccupancyGrid, other: OccupancyGrid) -> bool:
    return one is other or (
        one.cells is other.cells
        and one.resolution_m == other.resolution_m
        and one.origin_xy == other.origin_xy
    )
