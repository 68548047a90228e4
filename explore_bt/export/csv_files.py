"""Tables as CSV files."""

from __future__ import annotations

import csv
import io
from collections.abc import Mapping
from pathlib import Path

from explore_bt.export.table import Table
from explore_bt.files import write_whole

__all__ = ["write_csv"]


def write_csv(tables: Mapping[str, Table], folder: Path) -> list[Path]:
    """``NAME.csv`` for each table: RFC 4180 in UTF-8, names first; an empty cell is an unknown figure.

    Raises:
        OSError: the folder cannot be written.
    """
    return [write_whole(folder / f"{name}.csv", _text(table)) for name, table in tables.items()]


def _text(table: Table) -> str:
    with io.StringIO(newline="") as text:
        writer = csv.writer(text)
        writer.writerow(table.columns)
        writer.writerows(table.rows())
        return text.getvalue()
