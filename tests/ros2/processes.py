"""Processes of a test: a robot, a mission; output is read as it comes."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

__all__ = ["Process", "stand_in_process", "until"]


def until(condition: Callable[[], object], deadline_s: float, what: str) -> None:
    """Wait for a condition; fail with what was waited for."""
    end_s = time.monotonic() + deadline_s
    while not condition():
        assert time.monotonic() < end_s, f"after {deadline_s:g} s: {what}"
        time.sleep(0.01)


@contextmanager
def stand_in_process(*words: str | Path) -> Iterator[subprocess.Popen[str]]:
    """Another node, by what follows ``python``; it has said that it runs, and is killed in the end."""
    environment = {**os.environ, "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST"}
    process = subprocess.Popen([sys.executable, *words], stdout=subprocess.PIPE, text=True, env=environment)
    try:
        assert process.stdout is not None
        assert "runs" in process.stdout.readline()
        yield process
    finally:
        process.kill()
        process.communicate()


class Process:
    """One ``explore-bt`` command."""

    def __init__(self, *words: str | Path, **environment: str) -> None:
        self.run = subprocess.Popen(
            [sys.executable, "-c", "from explore_bt.cli import main; main()", *map(str, words)],
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            env={**os.environ, "PYTHONUNBUFFERED": "1", **environment},
        )
        self.lines: list[str] = []
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()

    def __enter__(self) -> Process:
        return self

    def __exit__(self, *_: object) -> None:
        """Nothing of a test outlives it."""
        if self.run.poll() is None:
            self.run.kill()
            self.run.wait()

    @property
    def text(self) -> str:
        return "".join(self.lines)

    def wait_for(self, words: str, deadline_s: float = 60.0) -> None:
        """Until it has said so."""
        until(
            lambda: words in self.text or self.run.poll() is not None, deadline_s, f"{words!r} in {self.text}"
        )
        assert words in self.text, self.text

    def end(self, number: int = signal.SIGINT, deadline_s: float = 30.0) -> int:
        """Send a signal unless it is over, and wait for the end."""
        if self.run.poll() is None:
            self.run.send_signal(number)
        return self.finish(deadline_s)

    def finish(self, deadline_s: float) -> int:
        """Its exit code, when it has ended by itself."""
        try:
            code = self.run.wait(deadline_s)
        except subprocess.TimeoutExpired:
            self.run.kill()
            self.run.wait()
            raise AssertionError(f"not over after {deadline_s:g} s:\n{self.text}") from None
        self._reader.join(5.0)
        return code

    def _read(self) -> None:
        assert self.run.stdout is not None
        for line in self.run.stdout:
            self.lines.append(line)
        self.run.stdout.close()
