"""A table in columns."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

__all__ = ["Cell", "Table"]

Cell = str | int | float | bool | None
"""What stands in a table; None is a figure that nobody knows."""


class Table:
    """Grows row by row; a column that first turns up later is empty in the rows before.

    Attributes:
        columns: name -> cells, all of one length.
    """

    def __init__(self, *columns: str) -> None:
        self.columns: dict[str, list[Cell]] = {name: [] for name in columns}
        self._count = 0

    def __len__(self) -> int:
        return self._count

    def add(self, row: Mapping[str, Cell]) -> None:
        """Add a row; what it does not name is None."""
        for name in row:
            if name not in self.columns:
                self.columns[name] = [None] * self._count
        for name, cells in self.columns.items():
            cells.append(row.get(name))
        self._count += 1

    def rows(self) -> Iterator[tuple[Cell, ...]]:
        """Row by row."""
        return zip(*self.columns.values(), strict=True)
