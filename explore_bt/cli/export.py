"""``explore-bt export``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from explore_bt.cli.guard import guarded
from explore_bt.cli.human import count
from explore_bt.cli.recordings import open_recording
from explore_bt.errors import UserError

__all__ = ["export"]


@guarded
def export(
    run: Annotated[Path, typer.Argument(metavar="RUN", help="Folder of a run, or its recording.mcap.")],
    csv: Annotated[
        Path | None, typer.Option("--csv", metavar="DIR", help="Tables as CSV files, into a new folder.")
    ] = None,
    parquet: Annotated[
        Path | None, typer.Option("--parquet", metavar="DIR", help="The same tables as Parquet files.")
    ] = None,
) -> None:
    """Turn a recording into files for other programs.

    Tables: poses, truth, states, events, gate, transitions of nodes, numbers of the blackboard, counts of
    nodes. A recording that was cut off is exported up to its end.
    """
    from explore_bt.export import read_tables, require_parquet, write_csv, write_parquet

    if csv is None and parquet is None:
        raise UserError("nothing to export to; name a folder with --csv DIR or --parquet DIR")
    if parquet is not None:
        require_parquet()
    folders = [_new_folder(folder) for folder in (csv, parquet) if folder is not None]
    recording = open_recording(run)
    if recording.damage:
        typer.echo(f"{recording.path}: {recording.damage}", err=True)
    tables = read_tables(recording)
    for folder in folders:
        folder.mkdir(parents=True, exist_ok=True)
    written = write_csv(tables, csv) if csv is not None else []
    written += write_parquet(tables, parquet) if parquet is not None else []
    for path in written:
        typer.echo(f"{path}  {count(len(tables[path.stem]), 'row')}")


def _new_folder(folder: Path) -> Path:
    if folder.is_file() or (folder.is_dir() and any(folder.iterdir())):
        raise UserError(f"{folder} is {'a file' if folder.is_file() else 'not empty'}; name a new folder")
    return folder
