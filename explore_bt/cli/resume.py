"""``explore-bt resume``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from explore_bt.cli.driving import (
    HeadlessOption,
    SinkOption,
    VerboseOption,
    drive,
    exit_code,
    show_result,
)
from explore_bt.cli.guard import guarded
from explore_bt.cli.human import duration
from explore_bt.cli.run_log import run_log
from explore_bt.cli.sinks import watched_sinks
from explore_bt.cli.stopping import stopping_by_signal

__all__ = ["resume"]


@guarded
def resume(
    run: Annotated[Path, typer.Argument(metavar="RUN", help="The folder of a run that broke off.")],
    set_: Annotated[
        list[str] | None,
        typer.Option("--set", metavar="NAME=VALUE", help="Set a parameter or a limit anew; may be repeated."),
    ] = None,
    headless: HeadlessOption = False,
    sink: SinkOption = None,
    verbose: VerboseOption = False,
) -> None:
    """Go on with a run that broke off, in the same map.

    Killed, stopped by hand or out of budget: all the same.

    The mission is the one the run began with, even if its file has changed since; distance, time and
    recording go on where they stood. A run that used up its budget needs more: --set limits.time='40 min'.

    Exit code: as of run.
    """
    from explore_bt.recovery import find_broken_off

    broken = find_broken_off(run, set_ or ())
    for note in broken.notes:
        typer.echo(f"note       {note}")
    cut, seed = broken.run, broken.run.memory.origin.seed
    typer.echo(f"{run}: goes on at {duration(cut.stamp_s)}, part {cut.memory.parts + 1}: getting ready")
    sinks = watched_sinks(broken.registry, sink or (), headless=headless)
    from explore_bt.runtime import StopFlag, pace_of

    stop = StopFlag()
    with run_log(run / "run.log", verbose=verbose, goes_on=True), stopping_by_signal(stop):
        attendant = pace_of(broken.mission)
        result = drive(broken.mission, broken.registry, run, seed, sinks, stop, attendant, resumed=cut)
    show_result(result, run)
    raise typer.Exit(exit_code(result.outcome))
