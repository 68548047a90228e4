"""``explore-bt recover``."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import Annotated

import typer

from explore_bt.cli.driving import show_result
from explore_bt.cli.guard import guarded
from explore_bt.errors import UserError

__all__ = ["recover"]


@guarded
def recover(
    source: Annotated[
        Path, typer.Argument(metavar="RUN", help="The folder of a run that broke off, or a recording.")
    ],
    out: Annotated[
        Path | None, typer.Option(metavar="DIR", help="Folder for the files, new; else RUN-recovered.")
    ] = None,
    overwrite: Annotated[bool, typer.Option("--overwrite", help="Replace what is in that folder.")] = False,
) -> None:
    """Save what a killed run left.

    A whole recording, map, trajectory and report.

    Nothing in RUN is changed. Map and trajectory hold everything up to the last recorded second where the
    run folder has a checkpoint; of a recording alone they are as it was recorded, at most 2 s older.

    Exit code: 0 saved, 2 there is nothing to save.
    """
    from explore_bt.recovery import recover as save

    target = out or source.with_name(
        f"{source.resolve().stem if source.is_file() else source.resolve().name}-recovered"
    )
    if target.exists() and (target.is_file() or any(target.iterdir())) and not overwrite:
        raise UserError(f"{target} is there already; --overwrite replaces it, --out names another folder")
    if target.resolve() == source.resolve() or target.resolve() in source.resolve().parents:
        raise UserError(f"{target} is, or holds, the run itself; name another folder with --out")
    draft = target.with_name(f".{target.name}.unfinished")
    shutil.rmtree(draft, ignore_errors=True)
    try:
        saved = save(source, draft)
        if target.exists():
            shutil.rmtree(target)
        draft.rename(target)
    finally:
        shutil.rmtree(draft, ignore_errors=True)
    for note in saved.notes:
        typer.echo(f"note       {note}")
    typer.echo(f"recording  {saved.damage or 'was whole already'}")
    show_result(saved.result, target)
