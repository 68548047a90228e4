"""Where missions are found and where runs are written."""

from __future__ import annotations

import difflib
import os
from datetime import datetime
from pathlib import Path

from explore_bt.errors import UserError
from explore_bt.files import missions_folder

__all__ = ["find_mission", "new_run_folder", "require_new_folder", "shipped_missions"]


def shipped_missions() -> dict[str, Path]:
    """The missions that come with explore-bt, by bare name."""
    return {path.stem: path for path in sorted(missions_folder().glob("[0-9]*.yaml"))}


def find_mission(text: str) -> Path:
    """The mission that a person means: a file, or the bare name of a shipped one.

    Raises:
        UserError: neither; lists the shipped ones.
    """
    path = Path(text)
    if path.is_file():
        return path
    shipped = shipped_missions()
    if text in shipped:
        return _short(shipped[text])
    if path.is_dir():
        raise UserError(f"{text} is a folder; name a mission file in it")
    close = difflib.get_close_matches(path.stem, shipped, n=1)
    hint = f'did you mean "{close[0]}"? ' if close else ""
    names = ", ".join(shipped) if shipped else "none"
    raise UserError(f"there is no mission {text}; {hint}Shipped missions: {names}")


def _short(path: Path) -> Path:
    """As a person here would write it."""
    return path.relative_to(Path.cwd()) if path.is_relative_to(Path.cwd()) else path


def new_run_folder(out: Path | None, mission: str) -> Path:
    """The folder for a run's files, not made yet: ``out``, else ``runs/<mission>-<time>``.

    Raises:
        UserError: it holds something (runs are never mixed or overwritten), or cannot be made.
    """
    folder = out or _free(Path("runs") / f"{mission}-{datetime.now():%Y%m%d-%H%M%S}")
    require_new_folder(folder, "--out")
    return folder


def require_new_folder(folder: Path, option: str) -> None:
    """Find out, before anything is written, whether a folder of this name can be made and filled.

    Raises:
        UserError: it holds something, or may not be made; names the option that gives another.
    """
    if folder.is_file():
        raise UserError(f"{folder} is a file; name a new folder with {option}")
    if folder.is_dir() and any(folder.iterdir()):
        raise UserError(
            f"{folder} is not empty; nothing is ever overwritten, name a new folder with {option}"
        )
    above = next(each for each in (folder, *folder.absolute().parents) if each.exists())
    if not above.is_dir():
        raise UserError(f"{folder} cannot be made: {above} is a file; name another folder with {option}")
    if not os.access(above, os.W_OK | os.X_OK):
        raise UserError(f"{folder}: you may not write into {above}; name another folder with {option}")


def _free(folder: Path) -> Path:
    number, candidate = 1, folder
    while candidate.exists():  # two runs begun in the same second
        number += 1
        candidate = folder.with_name(f"{folder.name}-{number}")
    return candidate
