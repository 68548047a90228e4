"""A fleet with a process for each robot, and what its watchers wrote down."""

from __future__ import annotations

import json
import math
import os
import shutil
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from machine import ROOT
from numpy.typing import NDArray

__all__ = ["Fleet", "Track", "apart_m", "doubly_claimed_s", "free_port", "running"]

_MAIN = "from explore_bt.cli import main; main()"
_LOOK_S = 0.02
_SAME_M = 0.2
"""Claims nearer than this are for the same view."""
_WATCHER = '''\
"""Writes down what everybody needs who compares several processes: with the time of the machine."""

import json
import time

from explore_bt import hookimpl
from explore_bt.interfaces import Sink


class Diary(Sink):
    """A line a tick."""

    name = "diary"
    api_version = 1

    def open(self, run):
        self.files = {robot: (run.folder / "diary.jsonl").open("a") for robot in run.trees}

    def on_tick(self, tick):
        for robot in tick.robots:
            pose = robot.true_pose
            line = [time.monotonic(), tick.stamp_s, pose.x, pose.y, robot.claims, str(robot.doing)]
            self.files[robot.robot].write(json.dumps([*line, robot.gate_reason]) + "\\n")
            self.files[robot.robot].flush()

    def on_event(self, event): ...

    def close(self, result): ...


@hookimpl
def explore_bt_register():
    return [Diary]
'''


def free_port() -> int:
    """Of this machine, at this moment."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


@dataclass
class Fleet:
    """Processes of a mission file; all that were started are killed with it.

    Attributes:
        folder: holds mission, world, trees, and a run folder for each robot.
        pace: simulated seconds a second.
        environs: robot -> variables that its mission asks for.
    """

    folder: Path
    pace: float = 1.0
    environs: dict[str, dict[str, str]] = field(default_factory=dict)
    processes: dict[str, subprocess.Popen[bytes]] = field(default_factory=dict)

    @classmethod
    def of(cls, folder: Path, mission: str, files: dict[str, str], pace: float = 1.0) -> Fleet:
        """Write mission, world and watcher into a folder."""
        folder.mkdir(parents=True, exist_ok=True)
        shutil.copytree(ROOT / "missions" / "trees", folder / "trees", dirs_exist_ok=True)
        for name, text in {"fleet.yaml": mission, "explore_bt_inline.py": _WATCHER, **files}.items():
            (folder / name).write_text(text)
        return cls(folder, pace)

    def start(self, robot: str, space: str = "") -> None:
        """Begin its run, in a network namespace if one is named."""
        words = ("run", str(self.folder / "fleet.yaml"), "--robot", robot, "--out", str(self.folder / robot))
        self.spawn(robot, (*words, "--pace", str(self.pace), "--headless", "--sink", "diary"), space)

    def resume(self, robot: str, space: str = "") -> None:
        """Go on with its run."""
        self.spawn(robot, ("resume", str(self.folder / robot), "--headless", "--sink", "diary"), space)

    def spawn(self, name: str, words: Sequence[str], space: str = "") -> None:
        """Any explore-bt command; its output goes to ``NAME.out``."""
        before = ("ip", "netns", "exec", space) if space else ()
        with (self.folder / f"{name}.out").open("ab") as out:
            self.processes[name] = subprocess.Popen(
                [*before, sys.executable, "-c", _MAIN, *words],
                stdout=out,
                stderr=subprocess.STDOUT,
                env={**os.environ, "OMP_NUM_THREADS": "1", **self.environs.get(name, {})},
                start_new_session=True,
            )

    def kill(self, name: str) -> None:
        """SIGKILL, at once."""
        process = self.processes[name]
        if process.poll() is None:
            os.killpg(process.pid, signal.SIGKILL)
        process.wait()

    def wait(self, names: Sequence[str], patience_s: float) -> None:
        """Until these have ended.

        Raises:
            TimeoutError: they have not.
        """
        end_s = time.monotonic() + patience_s
        while any(self.processes[name].poll() is None for name in names):
            if time.monotonic() > end_s:
                raise TimeoutError(f"{', '.join(names)} did not end in {patience_s:.0f} s: {self.said()}")
            time.sleep(_LOOK_S)

    def said(self) -> str:
        """The last words of all."""
        return "; ".join(f"{file.stem}: {file.read_text()[-500:]}" for file in self.folder.glob("*.out"))

    def result(self, robot: str) -> dict[str, Any]:
        """What its run ended with."""
        found: dict[str, Any] = json.loads((self.folder / robot / "result.json").read_text())
        return found

    def track(self, robot: str) -> Track:
        """What its watcher has written so far; empty before the first tick."""
        file = self.folder / robot / "diary.jsonl"
        lines = file.read_text().splitlines() if file.exists() else []
        return Track([row for line in lines if (row := _row(line)) is not None])

    def close(self) -> None:
        """Kill what is still there."""
        for name in self.processes:
            self.kill(name)


@contextmanager
def running(fleet: Fleet) -> Iterator[Fleet]:
    """The fleet while inside; then none of its processes is left."""
    try:
        yield fleet
    finally:
        fleet.close()


class Track:
    """Where a robot was, what it had claimed, by the machine's time."""

    def __init__(self, rows: Sequence[Sequence[Any]]) -> None:
        self.times_s = np.array([row[0] for row in rows])
        self.stamps_s = np.array([row[1] for row in rows])
        self.places = np.array([row[2:4] for row in rows]).reshape(-1, 2)
        self.claims = [row[4] for row in rows]
        self.doing = [str(row[5]) for row in rows]
        self.gate = [str(row[6]) for row in rows]

    def at(self, times_s: NDArray[np.float64]) -> NDArray[np.float64]:
        """(N, 2) metres; NaN while there was no process, or it had not ticked for a second."""
        found = np.column_stack([np.interp(times_s, self.times_s, self.places[:, axis]) for axis in (0, 1)])
        after = np.searchsorted(self.times_s, times_s).clip(1, len(self.times_s) - 1)
        is_known = (self.times_s[after] - self.times_s[after - 1] < 1.0) & (times_s <= self.times_s[-1])
        found[~(is_known & (times_s >= self.times_s[0]))] = math.nan
        return found

    def claims_at(self, time_s: float) -> list[list[float]]:
        """None while there was no process."""
        index = int(np.searchsorted(self.times_s, time_s)) - 1
        if index < 0 or time_s - self.times_s[index] > 1.0:
            return []
        return list(self.claims[index])


def apart_m(one: Track, other: Track, times_s: NDArray[np.float64]) -> NDArray[np.float64]:
    """(N,) metres between centres; NaN where one of them was not there."""
    return np.asarray(np.hypot(*(one.at(times_s) - other.at(times_s)).T))


def doubly_claimed_s(one: Track, other: Track, times_s: NDArray[np.float64]) -> float:
    """The longest time for which both had claimed the same."""
    longest, since = 0.0, None
    for time_s in times_s.tolist():
        theirs = other.claims_at(time_s)
        is_double = any(math.dist(a, b) < _SAME_M for a in one.claims_at(time_s) for b in theirs)
        since = (since if since is not None else time_s) if is_double else None
        longest = max(longest, time_s - since if since is not None else 0.0)
    return longest


def _row(line: str) -> list[Any] | None:
    try:
        found = json.loads(line)
    except ValueError:  # the last line of one that was killed
        return None
    return found if len(found) == 7 else None
