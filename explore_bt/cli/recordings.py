"""Where the recording of a run is found."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from explore_bt.errors import UserError

if TYPE_CHECKING:
    from explore_bt.recording import Recording

__all__ = ["open_recording"]


def open_recording(run: Path) -> Recording:
    """The recording that a person means: a run's folder, or the file itself; cut ones too.

    Raises:
        UserError: there is none, or it cannot be read.
    """
    from explore_bt.recording import read_recording

    path = run / "recording.mcap" if run.is_dir() else run
    if not path.is_file():
        where = f"{run} holds no recording.mcap" if run.is_dir() else f"there is no {run}"
        raise UserError(f"{where}; name the folder of a run, or its recording.mcap")
    return read_recording(path)
