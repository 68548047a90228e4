"""Files that ship, and files that are whole or not there at all."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path

__all__ = ["missions_folder", "sync_files", "write_whole"]


def missions_folder() -> Path:
    """Where the missions that ship are: in the package of a wheel, beside it in a checkout."""
    package = Path(__file__).parent
    return package / "missions" if (package / "missions").is_dir() else package.parent / "missions"


def sync_files(folder: Path) -> None:
    """Have all that was written to the files right in a folder on the disk, so that a power cut spares it."""
    for path in folder.iterdir():
        if path.is_file():
            handle = os.open(path, os.O_RDONLY)
            try:
                os.fsync(handle)
            finally:
                os.close(handle)


def write_whole(path: Path, data: bytes | str) -> Path:
    """Write a file so that no reader, and no crash, ever meets half of it.

    Raises:
        OSError: the folder cannot be written; nothing is left behind then.
    """
    content = data.encode() if isinstance(data, str) else data
    handle, temporary = tempfile.mkstemp(prefix=f".{path.name}.", dir=path.parent)
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
        os.chmod(temporary, 0o644)
        os.replace(temporary, path)
    except BaseException:
        Path(temporary).unlink(missing_ok=True)
        raise
    return path
