"""The occupancy grid that SLAM gives and everybody else reads."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

__all__ = ["FREE", "OCCUPIED", "UNKNOWN", "GridWindow", "OccupancyGrid"]

UNKNOWN = -1
FREE = 0
OCCUPIED = 100


@dataclass(frozen=True, slots=True)
class GridWindow:
    """A half-open rectangle of cells: rows [row0, row1), columns [col0, col1)."""

    row0: int
    col0: int
    row1: int
    col1: int

    @property
    def is_empty(self) -> bool:
        """Whether the window holds no cell."""
        return self.row1 <= self.row0 or self.col1 <= self.col0

    @property
    def slices(self) -> tuple[slice, slice]:
        """Indices of the window in the grid's array."""
        return (slice(self.row0, self.row1), slice(self.col0, self.col1))

    def grown(self, by: int, shape: tuple[int, int]) -> GridWindow:
        """The window and ``by`` cells more on every side, as far as a grid of that shape goes."""
        return GridWindow(
            max(self.row0 - by, 0),
            max(self.col0 - by, 0),
            min(self.row1 + by, shape[0]),
            min(self.col1 + by, shape[1]),
        )

    def joined(self, other: GridWindow) -> GridWindow:
        """The smallest window that holds all cells of both."""
        if self.is_empty or other.is_empty:
            return other if self.is_empty else self
        return GridWindow(
            min(self.row0, other.row0),
            min(self.col0, other.col0),
            max(self.row1, other.row1),
            max(self.col1, other.col1),
        )

    def moved(self, rows: int, cols: int) -> GridWindow:
        """The window so many rows and columns further."""
        return GridWindow(self.row0 + rows, self.col0 + cols, self.row1 + rows, self.col1 + cols)


@dataclass(frozen=True, slots=True, eq=False)
class OccupancyGrid:
    """A trinary map in the ``map`` frame.

    Attributes:
        cells: (rows, cols) int8, read-only: ``FREE``, ``OCCUPIED`` or ``UNKNOWN``. Row 0 is the
            lowest y, column 0 the lowest x.
        resolution_m: metres per cell.
        origin_xy: (x, y) metres of the lower left **corner** of cell (0, 0).
        revision: grows with every change; two grids of one source with the same revision are equal.
    """

    cells: NDArray[np.int8]
    resolution_m: float
    origin_xy: tuple[float, float]
    revision: int = 0

    def __post_init__(self) -> None:
        self.cells.flags.writeable = False

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns."""
        return (self.cells.shape[0], self.cells.shape[1])

    @property
    def free(self) -> NDArray[np.bool_]:
        """(rows, cols) bool: known free cells."""
        return self.cells == FREE

    @property
    def occupied(self) -> NDArray[np.bool_]:
        """(rows, cols) bool: cells that hold an obstacle."""
        return self.cells == OCCUPIED

    @property
    def unknown(self) -> NDArray[np.bool_]:
        """(rows, cols) bool: cells nobody has seen yet."""
        return self.cells == UNKNOWN

    def cell_of(self, x: float, y: float) -> tuple[int, int]:
        """(row, col) of the cell that holds a point, which may lie outside the grid."""
        col = math.floor((x - self.origin_xy[0]) / self.resolution_m)
        row = math.floor((y - self.origin_xy[1]) / self.resolution_m)
        return (row, col)

    def contains_cell(self, row: int, col: int) -> bool:
        """Whether the cell lies inside the grid."""
        return 0 <= row < self.cells.shape[0] and 0 <= col < self.cells.shape[1]

    def value_at(self, x: float, y: float) -> int:
        """``FREE``, ``OCCUPIED`` or ``UNKNOWN`` at a point; outside is ``UNKNOWN``."""
        row, col = self.cell_of(x, y)
        return int(self.cells[row, col]) if self.contains_cell(row, col) else UNKNOWN

    def window_around(self, x: float, y: float, reach_m: float) -> GridWindow:
        """The cells within a square about a point, to ``reach_m`` on every side, as far as the grid goes."""
        (row, col), reach = self.cell_of(x, y), math.ceil(reach_m / self.resolution_m)
        rows, cols = self.cells.shape
        return GridWindow(
            min(max(row - reach, 0), rows),
            min(max(col - reach, 0), cols),
            min(max(row + reach + 1, 0), rows),
            min(max(col + reach + 1, 0), cols),
        )

    def center_of(self, row: int, col: int) -> tuple[float, float]:
        """(x, y) metres of a cell's centre."""
        return (
            self.origin_xy[0] + (col + 0.5) * self.resolution_m,
            self.origin_xy[1] + (row + 0.5) * self.resolution_m,
        )

    def centers_of(self, cells: NDArray[np.integer]) -> NDArray[np.float64]:
        """(N, 2) float64 x, y in metres of the centres of (N, 2) integer rows and columns."""
        return (cells[:, ::-1].astype(np.float64) + 0.5) * self.resolution_m + np.asarray(self.origin_xy)

    def cells_of(self, points: NDArray[np.floating]) -> NDArray[np.int64]:
        """(N, 2) int64 rows and columns of (N, 2) points x, y in metres; may lie outside."""
        scaled = (np.asarray(points, dtype=np.float64) - np.asarray(self.origin_xy)) / self.resolution_m
        return np.floor(scaled[:, ::-1]).astype(np.int64)
