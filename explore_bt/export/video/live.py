"""A run filmed while it goes on: pictures of the simulated world."""

from __future__ import annotations

import logging
from pathlib import Path

from explore_bt.export.video.mp4 import Mp4Writer
from explore_bt.interfaces import Filming
from explore_bt.runtime import Attendant, Runner

__all__ = ["LiveFilm"]

_log = logging.getLogger(__name__)

_SIZE = (960, 540)
_RATE_HZ = 10.0
_SLACK_S = 1e-6


class LiveFilm(Attendant):
    """Takes a picture of the first robot's world every ``speed / 10`` seconds of mission time.

    Attributes:
        path: the file; it is there once the run is over, however it ended.
    """

    def __init__(self, path: Path, speed: float = 4.0) -> None:
        self.path = path
        self._step_s = speed / _RATE_HZ
        self._runner: Runner | None = None
        self._filming: Filming | None = None
        self._writer: Mp4Writer | None = None
        self._next_s = 0.0

    def begin(self, runner: Runner) -> None:
        """Set up the camera.

        Raises:
            UserError: what draws or writes the pictures is not installed.
        """
        self._runner, self._next_s = runner, runner.now_s
        self._filming = runner.robots[0].driver.filming(_SIZE)
        if self._filming is not None:
            self.path.parent.mkdir(parents=True, exist_ok=True)
            self._writer = Mp4Writer(self.path, _RATE_HZ, _SIZE)

    def on_period(self) -> None:
        """A picture, if one is due. A camera that breaks costs the film and not the run."""
        runner, writer = self._runner, self._writer
        if runner is None or writer is None or self._filming is None:
            return
        if runner.now_s < self._next_s - _SLACK_S:
            return
        self._next_s += self._step_s
        try:
            writer.write(self._filming.frame())
        except Exception:  # whatever a driver's pictures may raise
            _log.exception("the run cannot be filmed any more; %s is not written", self.path)
            writer.drop()
            self._writer = None

    def end(self) -> None:
        """The last picture is taken."""
        if self._filming is not None:
            self._filming.close()
        if self._writer is not None:
            self._writer.keep()
        self._filming = self._writer = None
