"""What every command that drives a mission shares: its options, its sinks, how it ends."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from explore_bt.cli.guard import DONE, FAILED, STOPPED, Crash
from explore_bt.cli.summary import summary_lines
from explore_bt.errors import UserError

if TYPE_CHECKING:
    from explore_bt.interfaces import Sink
    from explore_bt.mission import Mission
    from explore_bt.plugin import Registry
    from explore_bt.runtime import Attendant, CutRun, StopFlag
    from explore_bt.types import Outcome, Result

__all__ = [
    "GETTING_READY",
    "HeadlessOption",
    "OutOption",
    "PaceOption",
    "RobotOption",
    "SeedOption",
    "SinkOption",
    "VerboseOption",
    "drive",
    "exit_code",
    "show_result",
]

SeedOption = Annotated[
    int, typer.Option(min=0, metavar="N", help="Seed of every random draw; the same seed, the same run.")
]
OutOption = Annotated[
    Path | None,
    typer.Option(metavar="DIR", help="Folder for the results, new or empty; else runs/<mission>-<time>."),
]
RobotOption = Annotated[
    str | None,
    typer.Option(metavar="NAME", help="Only this robot; the others run elsewhere (team: zenoh)."),
]
PaceOption = Annotated[
    float, typer.Option(min=0.1, metavar="X", help="With --robot: simulated seconds a second.")
]
SinkOption = Annotated[
    list[str] | None,
    typer.Option(
        "--sink", metavar="NAME", help="One more observer (foxglove, or rerun,to=file); may be repeated."
    ),
]
HeadlessOption = Annotated[bool, typer.Option("--headless", help="No live view, a line every ten seconds.")]
VerboseOption = Annotated[bool, typer.Option("-v", "--verbose", help="Show the log.")]

GETTING_READY = "getting ready (the first time takes longer, it compiles)"


def drive(
    mission: Mission,
    registry: Registry,
    folder: Path,
    seed: int,
    sinks: Sequence[Sink],
    stop: StopFlag,
    attendant: Attendant | None = None,
    resumed: CutRun | None = None,
) -> Result:
    """Run the mission from its start, or from where it broke off, to its end.

    Raises:
        UserError: it asks for something that cannot be had.
        Crash: a fault of ours.
    """
    from explore_bt.runtime import run_mission

    try:
        return run_mission(
            mission,
            registry=registry,
            out=folder,
            seed=seed,
            sinks=sinks,
            stop=stop,
            attendant=attendant,
            resumed=resumed,
        )
    except UserError:
        raise
    except Exception as fault:
        raise Crash(folder) from fault


def show_result(result: Result, folder: Path) -> None:
    """Print how it ended and where the files are."""
    from rich.console import Console
    from rich.text import Text

    console = Console(highlight=False)
    for label, text in summary_lines(result, folder):
        line = Text(f"{label:<10} ", style="bold")
        path = Path(text)
        style = f"not bold link file://{path.resolve()}" if path.is_file() else "not bold"
        console.print(line.append(text, style=style), soft_wrap=True)


def exit_code(outcome: Outcome) -> int:
    """0 explored, 130 stopped by hand, else 1."""
    return {"explored": DONE, "stopped": STOPPED}.get(str(outcome), FAILED)
