"""What ``run`` and ``resume`` have in common."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from explore_bt.cli.guard import DONE, FAILED, STOPPED, Crash
from explore_bt.cli.stopping import stopping_by_signal
from explore_bt.cli.summary import summary_lines
from explore_bt.errors import UserError

if TYPE_CHECKING:
    from explore_bt.interfaces import Sink
    from explore_bt.mission import Mission
    from explore_bt.plugin import Registry
    from explore_bt.runtime import CutRun
    from explore_bt.types import Outcome, Result

__all__ = [
    "HeadlessOption",
    "SinkOption",
    "VerboseOption",
    "drive",
    "exit_code",
    "make_sinks",
    "show_summary",
]

HeadlessOption = Annotated[bool, typer.Option("--headless", help="No live view, a line every ten seconds.")]
SinkOption = Annotated[
    list[str] | None, typer.Option("--sink", metavar="NAME", help="One more observer; may be repeated.")
]
VerboseOption = Annotated[bool, typer.Option("-v", "--verbose", help="Show the log.")]


def drive(
    mission: Mission,
    registry: Registry,
    folder: Path,
    seed: int,
    sinks: Sequence[Sink],
    resumed: CutRun | None = None,
) -> Result:
    """The mission from its start, or from where it broke off, to its end; Ctrl-C stops the robots.

    Raises:
        UserError: it asks for something that cannot be had.
        Crash: a fault of ours.
    """
    from explore_bt.runtime import StopFlag, run_mission

    stop = StopFlag()
    with stopping_by_signal(stop):
        try:
            return run_mission(
                mission, registry=registry, out=folder, seed=seed, sinks=sinks, stop=stop, resumed=resumed
            )
        except UserError:
            raise
        except Exception as fault:
            raise Crash(folder) from fault


def make_sinks(registry: Registry, more: Sequence[str], *, live: bool) -> list[Sink]:
    """Recorder, report, what is shown on the screen, and whatever else was asked for."""
    names = ["mcap", "report", "terminal" if live else "progress", *more]
    classes: list[type[Sink]] = [registry.get("sink", name) for name in dict.fromkeys(names)]
    return [sink(sink.Options()) for sink in classes]


def show_summary(result: Result, folder: Path) -> None:
    """The last words on the screen."""
    from rich.console import Console
    from rich.text import Text

    console = Console(highlight=False)
    for label, text in summary_lines(result, folder):
        line = Text(f"{label:<10} ", style="bold")
        path = Path(text)
        style = f"not bold link file://{path.resolve()}" if path.is_file() else "not bold"
        console.print(line.append(text, style=style), soft_wrap=True)


def exit_code(outcome: Outcome) -> int:
    """How the command ends."""
    return {"explored": DONE, "stopped": STOPPED}.get(str(outcome), FAILED)
