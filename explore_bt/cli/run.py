"""``explore-bt run``."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from explore_bt.cli.guard import DONE, FAILED, STOPPED, Crash, guarded
from explore_bt.cli.loading import MissionArgument, MockOption, SetOption, load_checked
from explore_bt.cli.places import new_run_folder
from explore_bt.cli.run_log import run_log
from explore_bt.cli.sinks import make_sinks
from explore_bt.cli.stopping import stopping_by_signal
from explore_bt.cli.summary import summary_lines
from explore_bt.errors import UserError

if TYPE_CHECKING:
    from explore_bt.interfaces import Sink
    from explore_bt.mission import Mission
    from explore_bt.plugin import Registry
    from explore_bt.types import Outcome, Result

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
    headless: Annotated[
        bool, typer.Option("--headless", help="No live view, a line every ten seconds.")
    ] = False,
    sink: Annotated[
        list[str] | None,
        typer.Option(
            "--sink", metavar="NAME", help="One more observer (foxglove, or rerun,to=file); may be repeated."
        ),
    ] = None,
    mock: MockOption = None,
    verbose: Annotated[bool, typer.Option("-v", "--verbose", help="Show the log.")] = False,
) -> None:
    """Run a mission; map, recording and report land in a folder.

    Exit code: 0 explored, 1 failed or budget spent, 2 wrong input, 130 stopped by hand.
    Ctrl-C stops the robot safely and saves the results.
    """
    checked, registry = load_checked(mission, set_, mock)
    folder = new_run_folder(out, checked.path.stem)
    sinks = _sinks(registry, sink or (), live=not headless and sys.stdout.isatty())
    typer.echo(f"{checked.path}, seed {seed}: getting ready (the first time takes longer, it compiles)")
    with run_log(folder / "run.log", verbose=verbose):
        result = _drive(checked, registry, folder, seed, sinks)
    _show(result, folder)
    raise typer.Exit(_exit_code(result.outcome))


def _drive(mission: Mission, registry: Registry, folder: Path, seed: int, sinks: Sequence[Sink]) -> Result:
    from explore_bt.runtime import StopFlag, run_mission

    stop = StopFlag()
    with stopping_by_signal(stop):
        try:
            return run_mission(mission, registry=registry, out=folder, seed=seed, sinks=sinks, stop=stop)
        except UserError:
            raise
        except Exception as fault:
            raise Crash(folder) from fault


def _sinks(registry: Registry, more: Sequence[str], *, live: bool) -> list[Sink]:
    return make_sinks(registry, ["mcap", "report", "terminal" if live else "progress", *more])


def _show(result: Result, folder: Path) -> None:
    from rich.console import Console
    from rich.text import Text

    console = Console(highlight=False)
    for label, text in summary_lines(result, folder):
        line = Text(f"{label:<10} ", style="bold")
        path = Path(text)
        style = f"not bold link file://{path.resolve()}" if path.is_file() else "not bold"
        console.print(line.append(text, style=style), soft_wrap=True)


def _exit_code(outcome: Outcome) -> int:
    return {"explored": DONE, "stopped": STOPPED}.get(str(outcome), FAILED)
