"""``explore-bt new-plugin``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from explore_bt.cli.guard import guarded
from explore_bt.cli.skeleton import check_kind, check_name, write_skeleton

__all__ = ["new_plugin"]


@guarded
def new_plugin(
    kind: Annotated[
        str,
        typer.Argument(
            metavar="KIND", help="driver, slam, planner, controller, behaviour, sink or exporter."
        ),
    ],
    name: Annotated[
        str, typer.Argument(metavar="NAME", help="How missions will call it, for example my_slam.")
    ],
    out: Annotated[Path | None, typer.Option(metavar="DIR", help="The folder to make; else ./NAME.")] = None,
) -> None:
    """Write a working plugin of your own.

    One class, a few lines of TOML, and a test that passes: begin from there.
    """
    check_kind(kind)
    check_name(kind, name)
    folder = out or Path(name)
    for path in write_skeleton(kind, name, folder):
        typer.echo(path)
    typer.echo(
        f"\nNext: pip install -e {folder}\n      pytest {folder}\n      explore-bt plugins --kind {kind}"
    )
