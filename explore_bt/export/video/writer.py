"""A recording as a film in an MP4 file."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from explore_bt.export.video.film import HEIGHT, WIDTH, film, frame_count
from explore_bt.export.video.mp4 import Mp4Writer
from explore_bt.recording import Recording

__all__ = ["write_video"]


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
    step_s = speed / rate_hz
    total = frame_count(recording, step_s)
    with Mp4Writer(path, rate_hz, (WIDTH, HEIGHT)) as writer:
        for index, frame in enumerate(film(recording, step_s)):
            writer.write(frame)
            if on_frame is not None:
                on_frame(index + 1, total)
    return path
