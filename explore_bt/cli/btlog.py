"""``--btlog`` of ``explore-bt export``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from explore_bt.errors import UserError
from explore_bt.files import write_whole

if TYPE_CHECKING:
    from explore_bt.recording import Recording

__all__ = ["BtlogOption", "require_btlog", "write_btlogs"]

BtlogOption = Annotated[
    Path | None,
    typer.Option("--btlog", metavar="FILE", help="The tree's transitions for Groot2; a file a robot."),
]


def require_btlog(out: Path) -> None:
    """What can be found out before a recording is read.

    Raises:
        UserError: a name that Groot2 would not open, or no such folder.
    """
    if out.suffix != ".btlog":
        raise UserError(
            f"{out} does not end with .btlog, as Groot2 wants it; write {out.with_suffix('.btlog')}"
        )
    if not out.parent.is_dir():
        raise UserError(f"there is no folder {out.parent} to write {out.name} into; make it first")


def write_btlogs(recording: Recording, out: Path) -> list[Path]:
    """Write ``out``, or one file for each of several robots: ``run-ann.btlog``, ``run-bob.btlog``.

    Raises:
        UserError: see ``require_btlog``.
    """
    from explore_bt.recording import btlog

    require_btlog(out)
    if len(recording.robots) == 1:
        return [write_whole(out, btlog(recording))]
    return [
        write_whole(out.with_name(f"{out.stem}-{robot}.btlog"), btlog(recording, robot))
        for robot in recording.robots
    ]
