"""``explore-bt schema``."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated

import typer

from explore_bt.cli.guard import guarded
from explore_bt.errors import UserError
from explore_bt.files import write_whole

__all__ = ["schema"]


@guarded
def schema(
    out: Annotated[
        Path | None, typer.Option(metavar="FILE", help="A file to write; else it is printed.")
    ] = None,
    folder: Annotated[
        Path, typer.Option(metavar="FOLDER", help="Where to look for explore_bt_inline.py.")
    ] = Path(),
) -> None:
    """Print the JSON Schema of missions, for your editor.

    It is made from the installed plugins: completion knows their options, units and defaults.
    """
    from explore_bt.mission import mission_schema
    from explore_bt.plugin import load_plugins

    text = json.dumps(mission_schema(load_plugins(inline_dir=folder).registry), indent=2) + "\n"
    if out is None:
        typer.echo(text, nl=False)
        return
    if not out.parent.is_dir():
        raise UserError(f"there is no folder {out.parent} to write {out.name} into; make it first")
    if out.is_dir():
        raise UserError(f"{out} is a folder; name a file in it, for example {out / 'schema.json'}")
    write_whole(out, text)
    typer.echo(f"{out} written")
