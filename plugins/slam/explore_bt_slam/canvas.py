"""The grid under construction: grows by chunks, changes in place, hands out immutable snapshots."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Callable, Mapping
from functools import reduce
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from explore_bt.types import FREE, OCCUPIED, UNKNOWN, GridWindow, OccupancyGrid, Pose2
from explore_bt_slam.log_odds import MISS, draw_sweep
from explore_bt_slam.sweep import Sweep

__all__ = ["Canvas"]

Painter: TypeAlias = Callable[[NDArray[np.int8], NDArray[np.float64]], GridWindow]
"""Changes cells, given them and the x, y of their corner; says within which of them a class changed."""

_GROWTH_M = 5.0
_HISTORY = 512
_SURFACE_DEPTH = 0.4
"""Cells behind a return at which its obstacle is drawn: 2 cm at 5 cm cells, two standard deviations of the
range noise. Drawn at the return itself, a wall in line with the cells gets a second layer of noise in front,
and every door loses up to 10 cm."""


class Canvas:
    """Occupancy evidence on a growing array whose corner is a multiple of the resolution.

    Args:
        resolution_m: side of a cell.
        body_radius_m: the robot's footprint, free wherever the robot has been.
        revision: to begin with.
    """

    def __init__(self, resolution_m: float, body_radius_m: float, revision: int = 0) -> None:
        self._cell_m = resolution_m
        self._body_m = body_radius_m
        self._chunk = max(math.ceil(_GROWTH_M / resolution_m), 1)
        self._corner = np.zeros(2, dtype=np.int64)  # column and row of cell (0, 0) on the endless grid
        self._evidence = np.zeros((0, 0), dtype=np.float32)
        self._cells = np.zeros((0, 0), dtype=np.int8)
        self._drawn = np.zeros((0, 0), dtype=np.int32)
        self._sweeps = 0
        self._revision = revision
        self._windows: deque[tuple[int, GridWindow]] = deque(maxlen=_HISTORY)
        self._whole_since = revision
        self._snapshot: OccupancyGrid | None = None

    @property
    def revision(self) -> int:
        """Grows with every change of any cell's class, and with every growth."""
        return self._revision

    def draw(self, sweep: Sweep, pose: Pose2) -> None:
        """Take in a sweep seen from ``pose``."""
        self._make_room(sweep, pose)
        self._note(self._draw(sweep, pose))

    def paint(self, bounds: NDArray[np.floating[Any]], painter: Painter) -> None:
        """Let somebody else classify the cells within (4,) x0, y0, x1, y1, metres, by his own evidence."""
        low = np.floor(bounds[:2] / self._cell_m).astype(np.int64)
        high = np.ceil(bounds[2:] / self._cell_m).astype(np.int64)
        self._make_room_for(low, high)
        (col0, row0), (col1, row1) = low - self._corner, high - self._corner
        cells = self._cells[row0:row1, col0:col1].copy()  # one memory layout, so that kernels compile once
        changed = painter(cells, np.asarray(low * self._cell_m, dtype=np.float64))
        self._cells[row0:row1, col0:col1] = cells
        self._note(changed.moved(row0, col0))

    def forget_near(self, position: tuple[float, float], radius_m: float) -> None:
        """Call occupied cells within a circle free, so weakly that the next return there is believed."""
        if not self._cells.size:
            return
        centre = np.array(position) / self._cell_m - self._corner
        col0, row0 = np.maximum(np.floor(centre - radius_m / self._cell_m).astype(int), 0)
        col1, row1 = np.ceil(centre + radius_m / self._cell_m).astype(int) + 1
        cells, evidence = self._cells[row0:row1, col0:col1], self._evidence[row0:row1, col0:col1]
        rows, cols = np.ogrid[row0 : row0 + cells.shape[0], col0 : col0 + cells.shape[1]]
        is_near = np.hypot(cols + 0.5 - centre[0], rows + 0.5 - centre[1]) * self._cell_m <= radius_m
        wanted = is_near & (cells == OCCUPIED)
        cells[wanted], evidence[wanted] = FREE, MISS
        if wanted.any():
            self._note(GridWindow(row0, col0, row0 + cells.shape[0], col0 + cells.shape[1]))

    def redraw(self, sweeps: list[tuple[Sweep, Pose2]]) -> None:
        """Forget all evidence and draw these sweeps in this order; the canvas never shrinks."""
        self._evidence[:] = 0.0
        self._cells[:] = UNKNOWN
        for sweep, pose in sweeps:
            self._make_room(sweep, pose)
            self._draw(sweep, pose)
        self._revision += 1
        self._whole_since = self._revision
        self._windows.clear()

    def snapshot(self) -> OccupancyGrid:
        """The present revision; the same object until it changes."""
        if self._snapshot is None or self._snapshot.revision != self._revision:
            corner = (float(self._corner[0]) * self._cell_m, float(self._corner[1]) * self._cell_m)
            self._snapshot = OccupancyGrid(self._cells.copy(), self._cell_m, corner, self._revision)
        return self._snapshot

    def changed_since(self, revision: int) -> GridWindow | None:
        """The window of all cells whose class may differ; None if everything may, or nobody knows."""
        if revision == self._revision:
            return GridWindow(0, 0, 0, 0)
        oldest = self._windows[0][0] if self._windows else self._revision + 1
        if revision < self._whole_since or revision > self._revision or revision + 1 < oldest:
            return None
        windows = [window for at, window in self._windows if at > revision]
        return reduce(GridWindow.joined, windows)

    def arrays(self) -> dict[str, NDArray[Any]]:
        """All that ``restore`` needs."""
        return {
            "canvas_corner": self._corner,
            "canvas_evidence": self._evidence,
            "canvas_cells": self._cells,
            "canvas_revision": np.array(self._revision),
        }

    def restore(self, arrays: Mapping[str, NDArray[Any]]) -> None:
        """Stand as when ``arrays`` were taken."""
        self._corner = arrays["canvas_corner"].astype(np.int64)
        self._evidence = arrays["canvas_evidence"].astype(np.float32)
        self._cells = arrays["canvas_cells"].astype(np.int8)
        self._drawn = np.zeros(self._cells.shape, dtype=np.int32)
        self._revision = int(arrays["canvas_revision"])
        self._whole_since = self._revision
        self._windows.clear()
        self._snapshot = None

    def _note(self, window: GridWindow) -> None:
        if not window.is_empty:
            self._revision += 1
            self._windows.append((self._revision, window))

    def _draw(self, sweep: Sweep, pose: Pose2) -> GridWindow:
        self._sweeps += 1
        window = np.array([2**31, 2**31, 0, 0], dtype=np.int64)
        draw_sweep(
            self._evidence,
            self._cells,
            self._drawn,
            self._sweeps,
            self._corner * self._cell_m,
            self._cell_m,
            pose.as_array(),
            sweep.origins,
            _behind_surface(sweep, _SURFACE_DEPTH * self._cell_m),
            sweep.hit,
            self._body_m,
            window,
        )
        return GridWindow(*map(int, window))

    def _make_room(self, sweep: Sweep, pose: Pose2) -> None:
        """Grow so that the sweep and the robot's body fit, by whole chunks."""
        margin = max(self._body_m, sweep.reach_m) + 2.0 * self._cell_m
        low = np.floor((np.array(pose.xy) - margin) / self._cell_m).astype(np.int64)
        high = np.floor((np.array(pose.xy) + margin) / self._cell_m).astype(np.int64) + 1
        self._make_room_for(low, high)

    def _make_room_for(self, low: NDArray[np.int64], high: NDArray[np.int64]) -> None:
        """Grow to hold columns and rows [low, high), each (2,), on the endless grid."""
        corner = self._corner if self._cells.size else low
        end = corner + np.array(self._cells.shape[::-1])
        below = -(-np.maximum(corner - low, 0) // self._chunk) * self._chunk
        above = -(-np.maximum(high - end, 0) // self._chunk) * self._chunk
        if not below.any() and not above.any():
            return
        pads = ((below[1], above[1]), (below[0], above[0]))
        self._corner = corner - below
        self._evidence = _padded(self._evidence, pads, 0)
        self._cells = _padded(self._cells, pads, UNKNOWN)
        self._drawn = _padded(self._drawn, pads, 0)
        self._revision += 1
        self._whole_since = self._revision
        self._windows.clear()


def _behind_surface(sweep: Sweep, depth_m: float) -> NDArray[np.float32]:
    """(N, 2) float32 ends of the rays, those of the returns moved on along their rays, base frame."""
    along = sweep.ends - sweep.origins
    length = np.maximum(np.hypot(along[:, 0], along[:, 1]), 1e-6)
    factor = np.where(sweep.hit, depth_m / length, 0.0)[:, None]
    return np.asarray(sweep.ends + factor * along, dtype=np.float32)


def _padded(array: NDArray[Any], pads: object, value: float) -> NDArray[Any]:
    return np.pad(array, pads, constant_values=value)  # type: ignore[call-overload]  # pads are (2, 2) ints
