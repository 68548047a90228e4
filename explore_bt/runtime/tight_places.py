"""Places where the safety gate would not let the robot through, as obstacles for the planner."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import cast

from explore_bt.types import OCCUPIED, OccupancyGrid

__all__ = ["TightPlaces"]

_SAME_M = 0.3


class TightPlaces:
    """Marks in the map where the gate held the robot again and again.

    The map's cells are 5 cm wide and the gate is finer: a passage that the map calls wide enough may be
    too tight by a centimetre. One occupied cell in its middle closes it for plans and for exploration.
    """

    def __init__(self) -> None:
        self._positions: list[tuple[float, float]] = []
        self._opened: list[tuple[float, float]] = []
        self._marked: OccupancyGrid | None = None
        self._source: OccupancyGrid | None = None

    def add(self, position: tuple[float, float]) -> None:
        """Close the place at x, y in metres, ``map`` frame."""
        self._positions.append(position)
        self._source = None

    def reopen(self, chances: int) -> int:
        """Open those again that were not yet opened ``chances`` times, within 0.3 m; how many that were."""
        again = [place for place in self._positions if self._times_opened(place) < chances]
        self._positions = [place for place in self._positions if place not in again]
        self._opened += again
        self._source = None
        return len(again)

    def memory(self) -> Mapping[str, object]:
        """All places, closed and opened again."""
        return {"closed": tuple(self._positions), "opened": tuple(self._opened)}

    def restore(self, memory: Mapping[str, object]) -> None:
        """Have them again."""
        places = cast(Mapping[str, tuple[tuple[float, float], ...]], memory)
        self._positions, self._opened = list(places["closed"]), list(places["opened"])
        self._source = None

    def _times_opened(self, place: tuple[float, float]) -> int:
        return sum(math.dist(place, other) <= _SAME_M for other in self._opened)

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
