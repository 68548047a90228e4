"""Files that ship, and files that are whole or not there at all."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

__all__ = ["RECORDING", "WholeFile", "missions_folder", "sync", "sync_files", "whole_file", "write_whole"]

RECORDING = "recording.mcap"
"""What a run calls its recording."""


def missions_folder() -> Path:
    """Where the missions that ship are: in the package of a wheel, beside it in a checkout."""
    package = Path(__file__).parent
    return package / "missions" if (package / "missions").is_dir() else package.parent / "missions"


def sync(path: Path) -> None:
    """Have what was written to a file, or the names in a folder, on the disk: a power cut spares it then."""
    handle = os.open(path, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)


def sync_files(folder: Path) -> None:
    """Have all that was written to the files right in a folder on the disk."""
    for path in folder.iterdir():
        if path.is_file():
            sync(path)


class WholeFile:
    """A file that no reader, and no crash, ever meets half of.

    Attributes:
        draft: where to write: beside ``path``, with its suffix.
    """

    def __init__(self, path: Path) -> None:
        """Begin.

        Raises:
            OSError: the folder cannot be written.
        """
        handle, name = tempfile.mkstemp(prefix=f".{path.stem}.", suffix=path.suffix, dir=path.parent)
        os.close(handle)
        self._path, self.draft = path, Path(name)

    def keep(self) -> None:
        """The draft is finished: it takes the name."""
        sync(self.draft)
        self.draft.chmod(0o644)
        self.draft.replace(self._path)

    def drop(self) -> None:
        """Leave nothing behind. Idempotent."""
        self.draft.unlink(missing_ok=True)


@contextmanager
def whole_file(path: Path) -> Iterator[Path]:
    """A ``WholeFile``'s draft: kept when the block ends, dropped if it breaks off.

    Raises:
        OSError: the folder cannot be written.
    """
    file = WholeFile(path)
    try:
        yield file.draft
        file.keep()
    except BaseException:
        file.drop()
        raise


def write_whole(path: Path, data: bytes | str) -> Path:
    """Write a file so that no reader, and no crash, ever meets half of it.

    Raises:
        OSError: the folder cannot be written; nothing is left behind then.
    """
    with whole_file(path) as temporary:
        temporary.write_bytes(data.encode() if isinstance(data, str) else data)
    return path
