"""Numbered lines of a text file: plain, ``.gz`` or ``.bz2``, known by their first bytes."""

from __future__ import annotations

import bz2
import gzip
import zlib
from collections.abc import Iterator
from io import BufferedIOBase, BufferedReader
from pathlib import Path
from typing import cast

from explore_bt.errors import LogCutOff, LogError

__all__ = ["TextLines"]

_LONGEST_LINE = 1 << 22


class TextLines:
    """Reads line by line; ``progress`` counts bytes of the file itself, compressed or not."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self._size, self._done = 0, 0

    @property
    def progress(self) -> float:
        """Share [0, 1] of the file's bytes read so far."""
        return min(self._done / self._size, 1.0) if self._size else 0.0

    def __iter__(self) -> Iterator[tuple[int, bytes]]:
        """Each line with its number from 1; the last one may lack its line end.

        Raises:
            LogError: the file cannot be read, is empty, or its compression is damaged.
            LogCutOff: the compressed file ends too early.
        """
        with self._opened() as raw:
            text = _decompressed(raw)
            number = 0
            while True:
                try:
                    line = text.readline(_LONGEST_LINE)
                except EOFError:
                    raise LogCutOff(
                        f"{self._path}: cut off: the compressed file ends at byte {self._size}, after line "
                        f"{number}; get the whole file"
                    ) from None
                except (OSError, zlib.error, ValueError) as error:
                    raise LogError(
                        f"{self._path}: its compression is damaged near byte {raw.tell()}, after line "
                        f"{number} ({error}); get a sound copy"
                    ) from None
                if not line:
                    break
                number += 1
                if len(line) == _LONGEST_LINE:
                    raise LogError(f"{self._path}:{number}: no line end in 4 MB; expected a text log")
                self._done = raw.tell()
                yield number, line
            self._done = self._size

    def _opened(self) -> BufferedReader:
        try:
            self._size = self._path.stat().st_size
            raw = self._path.open("rb")
        except OSError as error:
            reason = (error.strerror or str(error)).lower()
            raise LogError(f"{self._path}: cannot be read ({reason}); give a log file") from None
        if self._size == 0:
            raw.close()
            raise LogError(f"{self._path}: an empty file; expected a log")
        return raw


def _decompressed(raw: BufferedReader) -> BufferedIOBase:
    begin = raw.peek(3)[:3]
    if begin[:2] == b"\x1f\x8b":
        return cast(BufferedIOBase, gzip.GzipFile(fileobj=raw, mode="rb"))
    return bz2.BZ2File(raw, mode="rb") if begin == b"BZh" else raw
