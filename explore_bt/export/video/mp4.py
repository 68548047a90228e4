"""Frames into an MP4 file."""

from __future__ import annotations

from pathlib import Path
from types import TracebackType
from typing import Self

import cv2
import numpy as np
from numpy.typing import NDArray

from explore_bt.errors import UserError
from explore_bt.files import WholeFile

__all__ = ["Mp4Writer"]

_CODEC = "vp09"  # of what OpenCV's wheel can write, what browsers and players of today show


class Mp4Writer:
    """VP9 in MP4; the file is whole, or not there at all.

    Leaving its ``with`` block without an exception keeps the file; ``keep`` and ``drop`` do it without one.
    """

    def __init__(self, path: Path, rate_hz: float, size: tuple[int, int]) -> None:
        """Begin beside the place of the file.

        Args:
            path: the file; its folder is there.
            rate_hz: frames a second.
            size: width and height, pixels.

        Raises:
            UserError: this build of OpenCV cannot write such files.
            OSError: the folder cannot be written.
        """
        self._file = WholeFile(path)
        self._writer = cv2.VideoWriter(str(self._file.draft), cv2.VideoWriter.fourcc(*_CODEC), rate_hz, size)
        if not self._writer.isOpened():
            self.drop()
            raise UserError(
                "this build of OpenCV cannot write VP9 in MP4; "
                "type: pip install --force-reinstall opencv-python-headless"
            )

    def write(self, frame: NDArray[np.uint8]) -> None:
        """One more frame, (height, width, 3) uint8 RGB."""
        self._writer.write(cv2.cvtColor(frame, cv2.COLOR_RGB2BGR))

    def keep(self) -> None:
        """The film is over: put the file in its place."""
        self._writer.release()
        self._file.keep()

    def drop(self) -> None:
        """Leave no file. Idempotent."""
        self._writer.release()
        self._file.drop()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if kind is None:
            self.keep()
        else:
            self.drop()
