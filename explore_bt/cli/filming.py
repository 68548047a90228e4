"""``--video`` of a run: the simulated world as a film."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from explore_bt.errors import UserError

if TYPE_CHECKING:
    from explore_bt.mission import Mission
    from explore_bt.runtime import Attendant

__all__ = ["VideoOption", "film_of", "require_mp4"]

VideoOption = Annotated[
    Path | None,
    typer.Option("--video", metavar="FILE.mp4", help="Film the simulated world, at four times its speed."),
]


def require_mp4(path: Path) -> None:
    """Refuse what is no new MP4 file.

    Raises:
        UserError: another suffix, or the file is there.
    """
    if path.suffix.lower() != ".mp4":
        raise UserError(f"{path}: videos are MP4 files; write {path.with_suffix('.mp4')}")
    if path.exists():
        raise UserError(f"{path} is there already; name another file")


def film_of(mission: Mission, path: Path | None) -> list[Attendant]:
    """Who films the run; nobody where no film is wanted.

    Raises:
        UserError: the first robot's driver has no world that could be filmed, or the file cannot be made.
    """
    if path is None:
        return []
    require_mp4(path)
    driver = mission.robots[0].driver
    if not driver.cls.films:
        raise UserError(
            f"--video films a world with looks, and {driver.name} has none; take driver mujoco, or film the "
            f"map after the run: explore-bt export RUN --video {path}"
        )
    from explore_bt.export.video import LiveFilm

    return [LiveFilm(path)]
