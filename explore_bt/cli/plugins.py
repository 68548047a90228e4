"""``explore-bt plugins``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from explore_bt.cli.guard import guarded
from explore_bt.errors import UserError

if TYPE_CHECKING:
    from rich.console import Console

    from explore_bt.plugin import BrokenPlugin, Entry

__all__ = ["plugins"]


@guarded
def plugins(
    kind: Annotated[
        str | None, typer.Option(metavar="KIND", help="Only this kind: driver, slam, planner, ...")
    ] = None,
    options: Annotated[
        bool, typer.Option("--options", help="With options or ports, units and defaults.")
    ] = False,
    folder: Annotated[
        Path, typer.Option(metavar="FOLDER", help="Where to look for explore_bt_inline.py.")
    ] = Path(),
) -> None:
    """List the plugins that a mission can use.

    A plugin that could not be loaded is named below the table, with the reason.
    """
    from explore_bt.plugin import KINDS, load_plugins

    if kind is not None and kind not in KINDS:
        raise UserError(f'there is no plugin kind "{kind}"; kinds are {", ".join(KINDS)}')
    host = load_plugins(inline_dir=folder)
    entries = [entry for entry in host.registry.entries() if kind in (None, entry.kind)]
    console = _console()
    if options:
        _show_options(entries, console)
    else:
        _show_table(entries, console)
    _show_broken(host.broken, console)


def _console() -> Console:
    import shutil

    from rich.console import Console

    # in a pipe nothing is cut off: one plugin, one line
    console = Console(highlight=False)
    return (
        console
        if console.is_terminal
        else Console(highlight=False, width=max(200, shutil.get_terminal_size().columns))
    )


def _show_table(entries: list[Entry], console: Console) -> None:
    from rich import box
    from rich.table import Table

    table = Table("kind", "name", "version", "origin", "what it is", box=box.SIMPLE_HEAD, pad_edge=False)
    for entry in entries:
        table.add_row(entry.kind, entry.name, entry.version, entry.origin, entry.doc)
    console.print(table if entries else "no plugin of that kind is installed")


def _show_options(entries: list[Entry], console: Console) -> None:
    from rich.table import Table
    from rich.text import Text

    from explore_bt.cli.options import options_of

    for entry in entries:
        console.print(Text.assemble((f"{entry.kind} {entry.name}", "bold"), f"  {entry.doc}"))
        table = Table(box=None, show_header=False, padding=(0, 2, 0, 2))
        rows = options_of(entry.cls)
        for option in rows:
            table.add_row(Text(option.name), Text(option.type), Text(option.default), Text(option.doc))
        console.print(table if rows else "  no options")
        console.print()


def _show_broken(broken: tuple[BrokenPlugin, ...], console: Console) -> None:
    from rich.text import Text

    for each in broken:
        console.print(Text.assemble(("left out  ", "red"), f"{each.name}, {each.origin}: {each.reason}"))
