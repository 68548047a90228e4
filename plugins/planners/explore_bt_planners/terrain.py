"""What the planners derive from one map for one width of robot."""

from __future__ import annotations

import math
from functools import cached_property

import cv2
import numpy as np
from numba import njit
from numpy.typing import NDArray

from explore_bt.types import GridWindow, OccupancyGrid
from explore_bt_planners.feature_transform import FeatureTransform
from explore_bt_planners.medial_axis import mark_axis, medial_axis
from explore_bt_planners.transform_update import paste

__all__ = ["SLACK_M", "Terrain"]

SLACK_M = 1e-6
"""Rounding allowed for in comparisons of clearances, metres."""


class Terrain:
    """One map as a robot of one width sees it; every field is computed at most once, then kept up to date.

    Attributes:
        grid: the map.
        threshold_m: clearance that a cell needs to be passable.
        transform: of the map; shared with the terrains of other widths.
    """

    def __init__(
        self, grid: OccupancyGrid, threshold_m: float, separation: float, transform: FeatureTransform
    ) -> None:
        self.grid = grid
        self.threshold_m = threshold_m
        self.transform = transform
        self._separation_cells = separation * threshold_m / grid.resolution_m
        cells = max(0.0, (threshold_m - SLACK_M) / grid.resolution_m + 0.5)
        self.min_squared = max(1, math.ceil(cells * cells))
        self._behind: GridWindow | None = None

    @cached_property
    def clearance_m(self) -> NDArray[np.float32]:
        """(rows, cols) float32, metres; equal to ``explore_bt.exploration.clearance_field``."""
        field = np.empty(self.transform.squared.shape, dtype=np.float32)
        _write_clearance(self.transform.squared, self.grid.resolution_m, field)
        return field

    @cached_property
    def passable(self) -> NDArray[np.bool_]:
        """(rows, cols) bool: cells whose centre is clear enough for the robot's."""
        return self.transform.squared >= self.min_squared

    @cached_property
    def skeleton(self) -> NDArray[np.bool_]:
        """(rows, cols) bool: the medial axis of the passable space."""
        return medial_axis(self.transform, self.min_squared, self._separation_cells)

    @cached_property
    def component(self) -> NDArray[np.int32]:
        """(rows, cols) int32: label of the connected piece of passable space, 0 outside of it.

        A diagonal step needs both cells beside it, so pieces are joined through edges only.
        """
        _, labels = cv2.connectedComponents(self.passable.view(np.uint8), connectivity=4, ltype=cv2.CV_32S)
        return np.asarray(labels, dtype=np.int32)

    def joins(self, one: tuple[int, int], other: tuple[int, int]) -> bool:
        """Whether two passable cells lie in one piece of passable space."""
        return bool(self.component[one] == self.component[other])

    def to_cells(self, x: float, y: float) -> tuple[float, float]:
        """(column, row) as real numbers: cell (row, col) is the square [col, col+1) × [row, row+1)."""
        ox, oy = self.grid.origin_xy
        return ((x - ox) / self.grid.resolution_m, (y - oy) / self.grid.resolution_m)

    def to_metres(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """(N, 2) x, y in the ``map`` frame of (N, 2) columns and rows as real numbers."""
        return points * self.grid.resolution_m + np.asarray(self.grid.origin_xy)

    def fall_behind(self, window: GridWindow) -> None:
        """The transform has changed within a window; ``catch_up`` before any field is read."""
        one = self._behind
        self._behind = window if one is None else one.joined(window)

    def catch_up(self, grid: OccupancyGrid) -> None:
        """Bring every field that was computed up to date with the transform of ``grid``, in place."""
        self.grid = grid
        window, self._behind = self._behind, None
        if window is None:
            return
        fields = vars(self)
        fields.pop("component", None)
        squared = self.transform.squared[window.slices]
        if "clearance_m" in fields:
            _write_clearance(squared, self.grid.resolution_m, self.clearance_m[window.slices])
        if "passable" in fields:
            self.passable[window.slices] = squared >= self.min_squared
        if "skeleton" in fields:
            self._mark(
                window.grown(1, self.transform.squared.shape)
            )  # a cell's mark depends on its neighbours

    def grow(self, transform: FeatureTransform, offset: tuple[int, int]) -> None:
        """Take the place in a larger map whose new cells are all obstacles; the rest is as it was.

        Args:
            transform: of the larger map.
            offset: row and column in it of this map's first cell.
        """
        old, shape = self.transform.squared.shape, transform.squared.shape
        self.transform = transform
        if self._behind is not None:
            self._behind = self._behind.moved(*offset)
        fields = vars(self)
        fields.pop("component", None)
        for name in fields.keys() & {"clearance_m", "passable", "skeleton"}:
            fields[name] = paste(np.zeros(shape, dtype=fields[name].dtype), fields[name], offset)
        if "skeleton" in fields:  # what was the border has neighbours now
            top, left = offset
            bottom, right = top + old[0], left + old[1]
            for row in (top, bottom - 1):
                self._mark(GridWindow(row, left, row + 1, right))
            for col in (left, right - 1):
                self._mark(GridWindow(top, col, bottom, col + 1))

    def _mark(self, window: GridWindow) -> None:
        mark_axis(self.skeleton, self.transform, self.min_squared, self._separation_cells, window)


@njit(cache=True)
def _write_clearance(squared, resolution, field):  # type: ignore[no-untyped-def]  # numba kernel
    half, cell = np.float32(0.5), np.float32(resolution)
    for r in range(squared.shape[0]):
        for c in range(squared.shape[1]):
            field[r, c] = max(np.sqrt(np.float32(squared[r, c])) - half, np.float32(0.0)) * cell
