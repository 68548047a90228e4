"""Frames into an MP4 file."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import cv2

from explore_bt.errors import UserError
from explore_bt.export.video.film import HEIGHT, WIDTH, film, frame_count
from explore_bt.files import whole_file
from explore_bt.recording import Recording

__all__ = ["write_video"]

_CODEC = "vp09"  # of what OpenCV's wheel can write, what browsers and players of today show


def write_video(
    recording: Recording,
    path: Path,
    *,
    rate_hz: float = 10.0,
    speed: float = 8.0,
    on_frame: Callable[[int, int], None] | None = None,
) -> Path:
    """An MP4 of 1280 × 720 pixels, VP9; whole, or not there at all.

    Args:
        recording: of a run, cut off or whole.
        path: the file.
        rate_hz: frames a second.
        speed: how many times faster than mission time.
        on_frame: told after each frame how many are done of how many.

    Raises:
        UserError: this build of OpenCV cannot write such files.
        OSError: the folder cannot be written.
    """
    with whole_file(path) as temporary:
        _write(recording, str(temporary), rate_hz, speed, on_frame)
    return path


def _write(
    recording: Recording, name: str, rate_hz: float, speed: float, on_frame: Callable[[int, int], None] | None
) -> None:
    writer = cv2.VideoWriter(name, cv2.VideoWriter.fourcc(*_CODEC), rate_hz, (WIDTH, HEIGHT))
    if not writer.isOpened():
        raise UserError(
            "this build of OpenCV cannot write VP9 in MP4; "
            "type: pip install --force-reinstall opencv-python-headless"
        )
    try:
        step_s = speed / rate_hz
        total = frame_count(recording, step_s)
        for index, frame in enumerate(film(recording, step_s)):
            writer.write(cv2.cvtColor(frame, cv2.COLOR_RGB2BGR))
            if on_frame is not None:
                on_frame(index + 1, total)
    finally:
        writer.release()
