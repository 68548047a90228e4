"""Where the recording of a run is found."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from explore_bt.errors import UserError
from explore_bt.files import RECORDING

if TYPE_CHECKING:
    from explore_bt.recording import Recording

__all__ = ["find_recording", "open_recording"]


def open_recording(run: Path | None) -> Recording:
    """The recording that a person means, see ``find_recording``; cut ones too.

    Raises:
        UserError: there is none, or it cannot be read.
    """
    from explore_bt.recording import read_recording

    return read_recording(find_recording(run))


def find_recording(run: Path | None) -> Path:
    """The file itself, or the one in a run's folder; the newest in ``runs/`` if none is named.

    Raises:
        UserError: it is not there.
    """
    if run is None:
        every = sorted(Path("runs").glob(f"*/{RECORDING}"), key=lambda path: path.stat().st_mtime)
        if not every:
            raise UserError(
                f"there is no recording in runs/ yet; name the folder of a run, or its {RECORDING}"
            )
        return every[-1]
    path = run / RECORDING if run.is_dir() else run
    if not path.is_file():
        where = f"{run} holds no {RECORDING}" if run.is_dir() else f"there is no {run}"
        raise UserError(f"{where}; name the folder of a run, or its {RECORDING}")
    return path
