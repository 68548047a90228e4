"""``explore-bt run``."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated

import typer

from explore_bt.cli.driving import (
    HeadlessOption,
    SinkOption,
    VerboseOption,
    drive,
    exit_code,
    make_sinks,
    show_summary,
)
from explore_bt.cli.guard import guarded
from explore_bt.cli.loading import MissionArgument, SetOption, load_checked
from explore_bt.cli.places import new_run_folder
from explore_bt.cli.run_log import run_log

__all__ = ["run"]


@guarded
def run(
    mission: MissionArgument,
    set_: SetOption = None,
    seed: Annotated[
        int, typer.Option(min=0, metavar="N", help="Seed of every random draw; the same seed, the same run.")
    ] = 0,
    out: Annotated[
        Path | None,
        typer.Option(metavar="DIR", help="Folder for the results, new or empty; else runs/<mission>-<time>."),
    ] = None,
    headless: HeadlessOption = False,
    sink: SinkOption = None,
    verbose: VerboseOption = False,
) -> None:
    """Run a mission; map, recording and report land in a folder.

    Exit code: 0 explored, 1 failed or budget spent, 2 wrong input, 130 stopped by hand.
    Ctrl-C stops the robot safely and saves the results; explore-bt resume goes on from there.
    """
    checked, registry = load_checked(mission, set_)
    folder = new_run_folder(out, checked.path.stem)
    sinks = make_sinks(registry, sink or (), live=not headless and sys.stdout.isatty())
    typer.echo(f"{checked.path}, seed {seed}: getting ready (the first time takes longer, it compiles)")
    with run_log(folder / "run.log", verbose=verbose):
        result = drive(checked, registry, folder, seed, sinks)
    show_summary(result, folder)
    raise typer.Exit(exit_code(result.outcome))
