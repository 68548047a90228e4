"""A mission is killed at random moments and resumed; is the map as good as an unbroken run's?

    python benchmarks/resume.py --kills 20 --out /tmp/resume

Real processes and real ``SIGKILL``s. Every other one falls while a checkpoint is being written, every fifth
run is killed a second time after it was resumed. A star marks a kill that left a checkpoint half written.
"""

from __future__ import annotations

import argparse
import json
import random
import shutil
import signal
import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
from machine import describe_machine

from explore_bt.maps import read_map
from explore_bt.recording import read_recording
from explore_bt.types import OCCUPIED, OccupancyGrid

_COVERAGE = 0.01
_ERROR_M = 0.02
_POLL_S = 0.0005


@dataclass(frozen=True, slots=True)
class _Figures:
    """What one run brought home; the map's error is the mean distance of its walls to the unbroken run's."""

    outcome: str
    coverage: float
    ate_m: float
    way_m: float
    time_s: float
    map_m: float

    @staticmethod
    def of(folder: Path, unbroken: Path) -> _Figures:
        result = json.loads((folder / "result.json").read_text())
        return _Figures(
            result["outcome"],
            result["coverage"],
            result["ate_rmse_m"],
            result["path_length_m"],
            result["mission_time_s"],
            _walls_apart_m(read_map(folder / "map.yaml"), read_map(unbroken / "map.yaml")),
        )


def main() -> int:
    """Kill, resume, compare."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--mission", default="01_apartment")
    parser.add_argument("--kills", type=int, default=20)
    parser.add_argument("--seed", type=int, default=0, help="of the moments")
    parser.add_argument("--out", type=Path, default=Path("runs/resume"))
    given = parser.parse_args()
    print(describe_machine())
    unbroken = given.out / "unbroken"
    begun_s = time.monotonic()
    _wait(_start("run", given.mission, "--headless", "--out", str(unbroken)))
    longest_s = time.monotonic() - begun_s
    expected = _Figures.of(unbroken, unbroken)
    print(f"unbroken: {_words(expected)}; {_cost(unbroken)}")
    print("run            killed at   outcome  coverage      ATE   walls      way    time")
    dice, good = random.Random(given.seed), 0
    for number in range(given.kills):
        folder = given.out / f"{number:02d}"
        moments = _broken_run(given.mission, folder, longest_s, number, dice)
        found = _Figures.of(folder, unbroken)
        is_good = (
            found.outcome == expected.outcome
            and found.coverage >= expected.coverage - _COVERAGE
            and found.ate_m <= expected.ate_m + _ERROR_M
        )
        good += is_good
        print(
            f"{number:>3} {' '.join(moments):>20} {found.outcome:>9} {found.coverage:>9.2%} "
            f"{1000 * found.ate_m:>5.1f} mm {1000 * found.map_m:>4.1f} mm {found.way_m:>6.1f} m "
            f"{found.time_s:>5.0f} s{'' if is_good else '  NOT AS GOOD'}",
            flush=True,
        )
    print(f"{good} of {given.kills} resumed to the end with a map as good as the unbroken run's")
    return 0 if good == given.kills else 1


def _broken_run(mission: str, folder: Path, longest_s: float, number: int, dice: random.Random) -> list[str]:
    """Run, kill, resume to the end; the moments of the kills in words."""
    in_checkpoint = number % 2 == 1
    moments = [_killed("run", mission, folder, longest_s, in_checkpoint, dice)]
    if number % 5 == 4:
        moments.append(_killed("resume", str(folder), folder, 0.3 * longest_s, in_checkpoint, dice))
    if not (folder / "result.json").exists():
        _wait(_start("resume", str(folder), "--headless"))
    return moments


def _killed(
    command: str, what: str, folder: Path, longest_s: float, in_checkpoint: bool, dice: random.Random
) -> str:
    """Start, kill at a random moment, and say at which mission time that was.

    A run that has ended before its moment came is begun again; one that is resumed may do so.
    """
    out = ["--out", str(folder)] if command == "run" else []
    before = _checkpoints(folder)
    process = _start(command, what, "--headless", *out)
    while process.poll() is None and _checkpoints(folder) <= before:
        time.sleep(_POLL_S)  # until the mission is under way
    share = dice.random()
    until_s = time.monotonic() + 0.8 * share * longest_s
    while process.poll() is None and time.monotonic() < until_s:
        time.sleep(_POLL_S)
    while in_checkpoint and process.poll() is None and not list(folder.glob("checkpoint/.unfinished-*")):
        time.sleep(_POLL_S)
    has_ended = process.poll() is not None
    process.send_signal(signal.SIGKILL)
    process.wait()
    if has_ended and command == "run":
        shutil.rmtree(folder)
        return _killed(command, what, folder, 0.8 * longest_s, in_checkpoint, dice)
    if has_ended:
        return "(ended)"
    torn = "*" if list(folder.glob("checkpoint/.unfinished-*")) else ""
    return f"{read_recording(folder / 'recording.mcap').duration_s:.1f} s{torn}"


def _checkpoints(folder: Path) -> int:
    """Tick of the newest checkpoint, -1 without any."""
    names = [each.name for each in folder.glob("checkpoint/*") if each.name.isdecimal()]
    return max(map(int, names), default=-1)


def _start(*words: str) -> subprocess.Popen[bytes]:
    return subprocess.Popen(
        [sys.executable, "-c", "from explore_bt.cli import main; main()", *words],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        start_new_session=True,
    )


def _wait(process: subprocess.Popen[bytes]) -> None:
    _, said = process.communicate()
    if process.returncode not in (0, 1):
        raise SystemExit(f"explore-bt ended with {process.returncode}: {said.decode()}")


def _walls_apart_m(one: OccupancyGrid, other: OccupancyGrid) -> float:
    """Mean distance of the walls of one map to those of another."""
    free = np.pad((other.cells != OCCUPIED).astype(np.uint8), 100, constant_values=1)
    away_m = cv2.distanceTransform(free, cv2.DIST_L2, cv2.DIST_MASK_PRECISE) * other.resolution_m
    rows, cols = np.nonzero(one.cells == OCCUPIED)
    cells = other.cells_of(one.centers_of(np.column_stack((rows, cols)))) + 100
    inside = ((cells >= 0) & (cells < np.array(free.shape))).all(axis=1)
    return float(away_m[cells[inside, 0], cells[inside, 1]].mean())


def _cost(folder: Path) -> str:
    """What the log says that checkpoints cost."""
    lines = [line for line in (folder / "run.log").read_text().splitlines() if "checkpoints took" in line]
    return lines[-1].split("INFO ")[-1] if lines else ""


def _words(figures: _Figures) -> str:
    return (
        f"{figures.outcome}, {figures.coverage:.2%}, ATE {1000 * figures.ate_m:.1f} mm, "
        f"{figures.way_m:.1f} m, {figures.time_s:.0f} s"
    )


if __name__ == "__main__":
    sys.exit(main())
