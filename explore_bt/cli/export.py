"""``explore-bt export``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from explore_bt.cli.btlog import BtlogOption, require_btlog, write_btlogs
from explore_bt.cli.filming import require_mp4
from explore_bt.cli.guard import guarded
from explore_bt.cli.human import count, duration
from explore_bt.cli.places import require_new_folder
from explore_bt.cli.recordings import open_recording
from explore_bt.errors import UserError

if TYPE_CHECKING:
    from explore_bt.recording import Recording

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
    video: Annotated[
        Path | None, typer.Option("--video", metavar="FILE.mp4", help="Map, tree and timeline as a film.")
    ] = None,
    speed: Annotated[
        float, typer.Option(min=0.1, max=1000, metavar="N", help="Of the video: times mission time.")
    ] = 8.0,
    rate: Annotated[
        float, typer.Option(min=1, max=60, metavar="HZ", help="Of the video: frames a second.")
    ] = 10.0,
    btlog: BtlogOption = None,
) -> None:
    """Turn a recording into files for other programs.

    Tables: poses, truth, states, events, gate, transitions of nodes, numbers of the blackboard, counts of
    nodes. A recording that was cut off is exported up to its end.
    """
    if csv is None and parquet is None and video is None and btlog is None:
        raise UserError(
            "nothing to export to; name --csv DIR, --parquet DIR, --video FILE.mp4 or --btlog FILE.btlog"
        )
    _require(csv, parquet, video)
    if btlog is not None:
        require_btlog(btlog)
    recording = open_recording(run)
    if recording.damage:
        typer.echo(f"{recording.path}: {recording.damage}", err=True)
    if csv is not None or parquet is not None:
        _export_tables(recording, csv, parquet)
    if btlog is not None:
        for path in write_btlogs(recording, btlog):
            typer.echo(path)
    if video is not None:
        _export_video(recording, video, rate, speed)


def _require(csv: Path | None, parquet: Path | None, video: Path | None) -> None:
    """Everything that can be found out before the first file is written."""
    from explore_bt.export import require_parquet

    if parquet is not None:
        require_parquet()
    for folder, option in ((csv, "--csv"), (parquet, "--parquet")):
        if folder is not None:
            require_new_folder(folder, option)
    if video is not None:
        require_mp4(video)


def _export_tables(recording: Recording, csv: Path | None, parquet: Path | None) -> None:
    from explore_bt.export import read_tables, write_csv, write_parquet

    tables = read_tables(recording)
    written = []
    for folder, write in ((csv, write_csv), (parquet, write_parquet)):
        if folder is not None:
            folder.mkdir(parents=True, exist_ok=True)
            written += write(tables, folder)
    for path in written:
        typer.echo(f"{path}  {count(len(tables[path.stem]), 'row')}")


def _export_video(recording: Recording, path: Path, rate_hz: float, speed: float) -> None:
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

    from explore_bt.export.video import write_video

    path.parent.mkdir(parents=True, exist_ok=True)
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    console = Console(stderr=True)
    with Progress(*columns, console=console, transient=True, disable=not console.is_terminal) as progress:
        task = progress.add_task("filming", total=None)
        write_video(
            recording,
            path,
            rate_hz=rate_hz,
            speed=speed,
            on_frame=lambda done, total: progress.update(task, completed=done, total=total),
        )
    typer.echo(f"{path}  {duration(recording.duration_s)} at {speed:g} ×")
