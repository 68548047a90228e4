"""Recordings as tables and as a video."""

from explore_bt.export.csv_files import write_csv
from explore_bt.export.parquet_files import require_parquet, write_parquet
from explore_bt.export.table import Table
from explore_bt.export.tables import TABLES, read_tables

__all__ = ["TABLES", "Table", "read_tables", "require_parquet", "write_csv", "write_parquet"]
