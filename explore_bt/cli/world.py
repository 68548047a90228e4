"""``explore-bt world``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from explore_bt.cli.guard import guarded
from explore_bt.errors import UserError
from explore_bt.files import write_whole

__all__ = ["world"]


@guarded
def world(
    out: Annotated[Path, typer.Option(metavar="FILE", help="The world file to write.")],
    kind: Annotated[
        str, typer.Option(metavar="KIND", help="apartment, office, or passages (a course of gaps).")
    ] = "apartment",
    seed: Annotated[int, typer.Option(metavar="N", help="The same seed gives the same world.")] = 0,
) -> None:
    """Draw a furnished flat, an office floor, or a course of gaps.

    Every room can be reached; missions take the file as their world.
    """
    from explore_bt.worlds import generate_world

    text = generate_world(kind, seed)
    if not out.parent.is_dir():
        raise UserError(f"there is no folder {out.parent} to write {out.name} into; make it first")
    if out.is_dir():
        raise UserError(f"{out} is a folder; name a file in it, for example {out / f'{kind}_{seed}.yaml'}")
    write_whole(out, text)
    typer.echo(f"{out} written\n\nNext: explore-bt run 02_any_map --set world={out}")
