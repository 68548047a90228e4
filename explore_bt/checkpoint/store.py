"""Checkpoints on disk: folders that are whole or not there, the last two of them."""

from __future__ import annotations

import fcntl
import hashlib
import json
import shutil
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from explore_bt.errors import UserError
from explore_bt.files import sync

__all__ = ["Checkpoint", "CheckpointError", "CheckpointStore", "Draft"]

FORMAT = "explore-bt-checkpoint/1"
_MANIFEST = "manifest.json"
_KEPT = 2
_UNFINISHED = ".unfinished-"
_LOCK = ".lock"


class CheckpointError(UserError):
    """A run folder without a checkpoint to go on from."""


@dataclass(frozen=True, slots=True)
class Checkpoint:
    """A checkpoint that was found whole: every file is there and as it was written."""

    folder: Path
    tick: int

    def read(self, name: str) -> bytes:
        """One of its files."""
        return (self.folder / name).read_bytes()


class Draft:
    """A checkpoint that is being written; nobody finds it before ``commit``."""

    def __init__(self, store: CheckpointStore, tick: int, before: Checkpoint | None) -> None:
        self._store = store
        self._before = before
        self.tick = tick
        self.folder = store.folder / f"{_UNFINISHED}{tick:09d}"
        shutil.rmtree(self.folder, ignore_errors=True)
        self.folder.mkdir(parents=True)

    def before(self, name: str) -> Path | None:
        """A folder of this name in the checkpoint before: files that did not change may be linked from it."""
        found = self._before.folder / name if self._before is not None else None
        return found if found is not None and found.is_dir() else None

    def write(self, name: str, text: str) -> None:
        """One file."""
        file = self.folder / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text, encoding="utf-8")

    def commit(self) -> Checkpoint:
        """Have everything on the disk, then under its name; older ones than the last two go.

        Raises:
            OSError: the disk is full, or gone.
        """
        known = _known(self._before)
        sums = {}
        for file in _files(self.folder):
            name = file.relative_to(self.folder).as_posix()
            sums[name] = known.get((name, file.stat().st_ino)) or _synced_sum(file)
        manifest = self.folder / _MANIFEST
        manifest.write_text(json.dumps({"format": FORMAT, "files": sums}, separators=(",", ":")))
        _synced_sum(manifest)
        for folder in (self.folder, *(each for each in self.folder.rglob("*") if each.is_dir())):
            sync(folder)
        final = self._store.folder / f"{self.tick:09d}"
        shutil.rmtree(final, ignore_errors=True)
        self.folder.rename(final)
        sync(self._store.folder)
        self._store.prune()
        return Checkpoint(final, self.tick)


class CheckpointStore:
    """The checkpoints of one run, in a folder of their own."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    @contextmanager
    def locked(self) -> Iterator[None]:
        """Keep other processes off this run while inside, or until this process is no more.

        Raises:
            CheckpointError: another process is at work on it.
        """
        self.folder.mkdir(parents=True, exist_ok=True)
        with (self.folder / _LOCK).open("wb") as file:
            try:
                fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except OSError:
                raise CheckpointError(
                    f"{self.folder.parent}: another process is at work on it; wait for its end, or stop it"
                ) from None
            yield

    def begin(self, tick: int, before: Checkpoint | None = None) -> Draft:
        """Start writing the checkpoint of a tick; ``before`` was written by the same run of the program."""
        return Draft(self, tick, before)

    def newest(self) -> tuple[Checkpoint, list[str]]:
        """The newest checkpoint that is whole, and a line for each newer one that is not.

        Raises:
            CheckpointError: there is none; says what is wrong with those that are there.
        """
        faults: list[str] = []
        for folder in self._folders():
            fault = _fault_of(folder)
            if not fault:
                return Checkpoint(folder, int(folder.name)), faults
            faults.append(f"checkpoint {folder} is not used: {fault}")
        said = "; ".join(faults) or "no checkpoint was ever written"
        raise CheckpointError(f"{self.folder}: nothing to go on from: {said}")

    def prune(self) -> None:
        """Keep the last two, and no draft of a process that died."""
        for folder in self._folders()[_KEPT:]:
            shutil.rmtree(folder, ignore_errors=True)
        for folder in self.folder.glob(f"{_UNFINISHED}*"):
            shutil.rmtree(folder, ignore_errors=True)

    def _folders(self) -> list[Path]:
        """Newest first."""
        if not self.folder.is_dir():
            return []
        return sorted((each for each in self.folder.iterdir() if each.name.isdecimal()), reverse=True)


def _fault_of(folder: Path) -> str:
    """What is wrong with a checkpoint, in words; empty if nothing is."""
    try:
        sums = _sums(folder)
    except (OSError, ValueError) as fault:
        return f"its {_MANIFEST} cannot be read: {fault}"
    if sums is None:
        return f"its {_MANIFEST} is not of the format {FORMAT}"
    here = {file.relative_to(folder).as_posix() for file in _files(folder)} - {_MANIFEST}
    if missing := sorted(set(sums) - here):
        return f"{missing[0]} is missing"
    if foreign := sorted(here - set(sums)):
        return f"{foreign[0]} does not belong to it"
    for name, expected in sums.items():
        try:
            found = _sum((folder / name).read_bytes())
        except OSError as fault:
            return f"{name} cannot be read: {fault.strerror}"
        if found != expected:
            return f"{name} is damaged: its checksum is another one"
    return ""


def _sums(folder: Path) -> dict[str, str] | None:
    manifest = json.loads((folder / _MANIFEST).read_bytes())
    if not isinstance(manifest, dict) or manifest.get("format") != FORMAT:
        return None
    files = manifest.get("files")
    if not isinstance(files, dict) or manifest.keys() != {"format", "files"}:
        return None
    return {str(name): str(checksum) for name, checksum in files.items()}


def _known(before: Checkpoint | None) -> Mapping[tuple[str, int], str]:
    """Name and inode -> checksum, of files that need not be read and synced again when linked."""
    if before is None:
        return {}
    found = _sums(before.folder) or {}
    return {(name, (before.folder / name).stat().st_ino): checksum for name, checksum in found.items()}


def _files(folder: Path) -> list[Path]:
    return sorted(file for file in folder.rglob("*") if file.is_file())


def _sum(data: bytes) -> str:
    return hashlib.sha256(data).hexdigest()


def _synced_sum(file: Path) -> str:
    """The checksum of a file that is on the disk by then."""
    sync(file)
    return _sum(file.read_bytes())
