"""``explore-bt compare``."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from explore_bt.cli.guard import guarded
from explore_bt.errors import UserError

if TYPE_CHECKING:
    from explore_bt.comparison import Figure, RunFacts

__all__ = ["compare"]


@guarded
def compare(
    runs: Annotated[
        list[Path], typer.Argument(metavar="RUN", help="Run folders, or recordings; two or more.")
    ],
    out: Annotated[Path, typer.Option(metavar="FILE", help="The page with the maps side by side.")] = Path(
        "compare.html"
    ),
    as_json: Annotated[
        bool, typer.Option("--json", help="Figures for programs on the standard output; no page.")
    ] = False,
) -> None:
    """Compare runs: figures in a table, maps side by side.

    The page with the maps opens offline.

    A run that was cut off counts as far as it was recorded. Differences are against the first run.
    """
    if len(runs) < 2:
        raise UserError(f"one run alone cannot be compared; name another, for example {runs[0]} runs/other")
    from explore_bt.comparison import comparison_page, figures_of, notes_on, read_run

    facts = _with_names(runs, [read_run(path) for path in runs])
    figures, notes = figures_of(facts), notes_on(facts)
    if as_json:
        typer.echo(json.dumps(_as_json(facts, figures, notes), indent=2))
        return
    _show(facts, figures, notes)
    _write(out, comparison_page(facts))
    typer.echo(f"maps  {out}")


def _with_names(paths: Sequence[Path], facts: Sequence[RunFacts]) -> list[RunFacts]:
    """Known by their last name, by their whole path where that is not enough."""
    from dataclasses import replace

    names = [run.name for run in facts]
    return [
        run if names.count(run.name) == 1 else replace(run, name=str(path))
        for path, run in zip(paths, facts, strict=True)
    ]


def _show(facts: Sequence[RunFacts], figures: Sequence[Figure], notes: Sequence[str]) -> None:
    from rich.console import Console
    from rich.table import Table
    from rich.text import Text

    console = Console(highlight=False)
    for note in notes:
        console.print(Text(f"note  {note}", style="yellow"), soft_wrap=True)
    table = Table(box=None, pad_edge=False, header_style="bold")
    table.add_column("")
    table.add_column("")
    for run in facts:
        table.add_column(Text(run.name), justify="right", overflow="fold")
    if len(facts) == 2:
        table.add_column("difference", justify="right")
    for figure in figures:
        style = "" if figure.differs else "dim"
        cells = [Text(text) for text in figure.texts]
        if len(facts) == 2:
            cells.append(Text(figure.differences[1]))
        table.add_row("≠" if figure.differs else "=", figure.label, *cells, style=style)
    console.print(table)


def _write(out: Path, page: str) -> None:
    from explore_bt.files import write_whole

    try:
        out.parent.mkdir(parents=True, exist_ok=True)
        write_whole(out, page)
    except OSError as error:
        raise UserError(f"{out} cannot be written: {error.strerror}; name another file with --out") from None


def _as_json(facts: Sequence[RunFacts], figures: Sequence[Figure], notes: Sequence[str]) -> dict[str, object]:
    return {
        "runs": [{"name": run.name, "folder": str(run.folder), **run.result} for run in facts],
        "differing": [figure.key for figure in figures if figure.differs],
        "notes": list(notes),
    }
