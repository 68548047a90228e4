"""``explore-bt stats``."""

from __future__ import annotations

import json
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from explore_bt.cli.guard import guarded
from explore_bt.cli.human import count, duration
from explore_bt.cli.recordings import open_recording

if TYPE_CHECKING:
    from explore_bt.recording import NodeStatistics, TreeStatistics

__all__ = ["stats"]


@guarded
def stats(
    runs: Annotated[
        list[Path], typer.Argument(metavar="RUN...", help="Folders of runs, or their recording.mcap.")
    ],
    never: Annotated[bool, typer.Option("--never", help="Only the nodes that no run has ticked.")] = False,
    as_json: Annotated[bool, typer.Option("--json", help="For programs.")] = False,
) -> None:
    """Count what each node did over many runs.

    The branch coverage of a tree. Nodes are the same if path and type are; trees that differ are said so,
    a node then counts in the runs that have it.
    """
    from explore_bt.recording import tree_statistics

    found = tree_statistics(open_recording(run) for run in runs)
    if as_json:
        typer.echo(json.dumps(_plain(found, never), indent=2, ensure_ascii=False))
    else:
        _show(found, never)


def _plain(found: TreeStatistics, never: bool) -> dict[str, object]:
    return {
        "runs": found.runs,
        "nodes": [
            {"path": node.path, "type": node.type, "runs": node.runs, "ticked_in": node.ticked_in}
            | asdict(node.total)
            for node in (found.never_ticked if never else found.nodes)
        ],
        "never_ticked": [node.path for node in found.never_ticked],
        "notes": list(found.notes),
    }


def _show(found: TreeStatistics, never: bool) -> None:
    from rich import box
    from rich.console import Console
    from rich.table import Table

    console = Console(highlight=False)
    if not console.is_terminal:
        console = Console(highlight=False, width=200)  # one node, one line
    columns = ("node", "ticked in", "ticks", "succeeded", "failed", "cut off", "running", "longest")
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    for column in columns:
        table.add_column(column, justify="left" if column == "node" else "right")
    for node in found.never_ticked if never else found.nodes:
        table.add_row(
            node.path if never else _name(node), *_figures(node), style="" if node.ticked_in else "yellow"
        )
    console.print(table)
    ticked = len(found.nodes) - len(found.never_ticked)
    share = f"{100.0 * ticked / max(len(found.nodes), 1):.0f} %"
    console.print(
        f"{ticked} of {count(len(found.nodes), 'node')} ticked in {count(found.runs, 'run')} ({share})"
    )
    for note in found.notes:
        console.print(note, markup=False, soft_wrap=True)


def _name(node: NodeStatistics) -> str:
    """Indented by its depth; the type where the name does not tell."""
    depth, name = node.path.count("/"), node.path.rpartition("/")[2]
    kind = "" if name == node.type else f" ({node.type})"
    return f"{'  ' * depth}{name}{kind}"


def _figures(node: NodeStatistics) -> tuple[str, ...]:
    total = node.total
    counts = (str(number or "·") for number in (total.successes, total.failures, total.cut_off))
    times = (duration(span_s) if span_s else "·" for span_s in (total.running_s, total.longest_s))
    return (f"{node.ticked_in}/{node.runs}", str(total.ticks or "never"), *counts, *times)
