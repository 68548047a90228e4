"""Places where the safety gate would not let the robot through, as obstacles for the planner."""

from __future__ import annotations

from dataclasses import replace

from explore_bt.types import OCCUPIED, OccupancyGrid

__all__ = ["TightPlaces"]


class TightPlaces:
    """Marks in the map where the gate held the robot again and again.

    The map's cells are 5 cm wide and the gate is finer: a passage that the map calls wide enough may be
    too tight by a centimetre. One occupied cell in its middle closes it for plans and for exploration.
    """

    def __init__(self) -> None:
        self._positions: list[tuple[float, float]] = []
        self._marked: OccupancyGrid | None = None
        self._source: OccupancyGrid | None = None

    def add(self, position: tuple[float, float]) -> None:
        """Close the place at x, y in metres, ``map`` frame."""
        self._positions.append(position)
        self._source = None

    def forget(self) -> None:
        """Open all of them again."""
        self._positions.clear()
        self._source = None

    def __len__(self) -> int:
        return len(self._positions)

    def mark(self, grid: OccupancyGrid) -> OccupancyGrid:
        """The grid with every tight place occupied; the grid itself where there is none."""
        if not self._positions:
            return grid
        if self._marked is None or self._source is not grid:
            cells = grid.cells.copy()
            for x, y in self._positions:
                row, col = grid.cell_of(x, y)
                if grid.contains_cell(row, col):
                    cells[row, col] = OCCUPIED
            self._marked, self._source = replace(grid, cells=cells), grid
        return self._marked
