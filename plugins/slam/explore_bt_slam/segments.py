"""Lists that only ever grow, in files of which only the last one changes."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

__all__ = ["read_segments", "write_segments"]

T = TypeVar("T")
_Arrays = dict[str, NDArray[Any]]

_SIZE = 64


def write_segments(
    folder: Path, before: Path | None, name: str, items: Sequence[T], pack: Callable[[Sequence[T]], _Arrays]
) -> None:
    """Write ``name-0000.npz``, ... of 64 items each, and ``name-rest.npz``.

    Args:
        folder: where to; it exists.
        before: where the beginning of the same list was written; full files are linked from there.
        name: of the list.
        items: all of them.
        pack: makes arrays of some; those of two parts, joined along their first axis, are those of both.
    """
    whole = len(items) // _SIZE
    for number in range(whole):
        file = folder / f"{name}-{number:04d}.npz"
        if before is None or not _linked(before / file.name, file):
            _write(file, pack(items[number * _SIZE : (number + 1) * _SIZE]))
    _write(folder / f"{name}-rest.npz", pack(items[whole * _SIZE :]))


def read_segments(folder: Path, name: str) -> _Arrays:
    """All arrays of a list, joined; empty where none was written.

    Raises:
        OSError, ValueError, KeyError, zipfile.BadZipFile: a file is damaged.
    """
    parts = [_read(file) for file in sorted(folder.glob(f"{name}-*.npz"))]
    return {key: np.concatenate([part[key] for part in parts]) for key in parts[0]} if parts else {}


def _linked(old: Path, new: Path) -> bool:
    try:
        os.link(old, new)
    except OSError:  # not there, or a file system without links
        return False
    return True


def _write(file: Path, arrays: _Arrays) -> None:
    everything: dict[str, Any] = dict(arrays)
    np.savez(file, **everything)  # not compressed: beams and points are noise, that is a tenth at best


def _read(file: Path) -> _Arrays:
    with np.load(file, allow_pickle=False) as opened:
        return {key: opened[key] for key in opened.files}
