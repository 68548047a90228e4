"""Tables as Parquet files; the extra ``tables`` brings the library."""

from __future__ import annotations

import importlib.util
import io
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from explore_bt.errors import UserError
from explore_bt.export.table import Cell, Table
from explore_bt.files import write_whole

if TYPE_CHECKING:
    import pyarrow

__all__ = ["require_parquet", "write_parquet"]


def require_parquet() -> None:
    """Find out before anything is written whether Parquet files can be.

    Raises:
        UserError: the library is not installed.
    """
    if importlib.util.find_spec("pyarrow") is None:
        raise UserError(
            'Parquet needs a library that is not installed; type: pip install "explore-bt[tables]"'
        )


def write_parquet(tables: Mapping[str, Table], folder: Path) -> list[Path]:
    """``NAME.parquet`` for each table, columns typed: text, float64, int64, bool.

    Raises:
        UserError: the library is not installed.
        OSError: the folder cannot be written.
    """
    require_parquet()
    import pyarrow
    from pyarrow import parquet

    written = []
    for name, table in tables.items():
        arrays = {column: pyarrow.array(cells, _type(cells)) for column, cells in table.columns.items()}
        with io.BytesIO() as file:
            parquet.write_table(pyarrow.table(arrays), file)
            written.append(write_whole(folder / f"{name}.parquet", file.getvalue()))
    return written


def _type(cells: list[Cell]) -> pyarrow.DataType:
    """What all cells are; a column of nothing is text, one of whole and broken numbers is of float64."""
    import pyarrow

    kinds = {type(cell) for cell in cells if cell is not None}
    if kinds and kinds <= {int, float}:
        return pyarrow.int64() if kinds == {int} else pyarrow.float64()
    return pyarrow.bool_() if kinds == {bool} else pyarrow.string()
