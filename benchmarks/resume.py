"""A mission is killed at random moments and resumed; is the map as good as an unbroken run's?

    python benchmarks/resume.py --kills 20 --out /tmp/resume

Real processes and real ``SIGKILL``s. Every other one falls while a checkpoint is being written, every fifth
run is killed a second time after it was resumed. A star marks a kill that left a checkpoint half written.
"""

from __future__ import annotations

import argparse
import json
import logging
import random
import signal
import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
from machine import describe_machine

from explore_bt.checkpoint import read_recent
from explore_bt.files import missions_folder
from explore_bt.maps import read_map
from explore_bt.mission import load_mission
from explore_bt.plugin import load_plugins
from explore_bt.recording import RECORDING, read_recording
from explore_bt.runtime import CHECKPOINTS, StopFlag, run_mission
from explore_bt.types import OCCUPIED, OccupancyGrid

_COVERAGE = 0.01
_ERROR_M = 0.02
_POLL_S = 0.001
_TREE_HZ = 10.0


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
    cost = _run_unbroken(given.mission, unbroken)
    expected = _Figures.of(unbroken, unbroken)
    print(f"unbroken: {_words(expected)}; {cost}")
    print("run            killed at   outcome  coverage      ATE   walls      way    time")
    dice, good = random.Random(given.seed), 0
    for number in range(given.kills):
        folder = given.out / f"{number:02d}"
        moments = _broken_run(given.mission, folder, 0.9 * expected.time_s, number, dice)
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


def _run_unbroken(mission: str, folder: Path) -> str:
    """The mission in this process, and what its log says that checkpoints cost."""
    lines: list[str] = []
    handler = logging.Handler()
    handler.emit = lambda record: lines.append(record.getMessage())  # type: ignore[method-assign]
    logger = logging.getLogger("explore_bt")
    logger.addHandler(handler)
    logger.setLevel(logging.DEBUG)
    registry = load_plugins().registry
    sinks = [registry.get("sink", name) for name in ("mcap", "report")]
    run_mission(
        load_mission(missions_folder() / f"{mission}.yaml", registry),
        registry=registry,
        out=folder,
        seed=0,
        sinks=[sink(sink.Options()) for sink in sinks],
        stop=StopFlag(),
    )
    return next((line for line in lines if "checkpoints took" in line), "no checkpoint")


def _broken_run(mission: str, folder: Path, longest_s: float, number: int, dice: random.Random) -> list[str]:
    """Run, kill, resume to the end; the moments of the kills in words."""
    in_checkpoint = number % 2 == 1
    first_s = dice.uniform(0.0, longest_s)
    moments = [_killed(["run", mission, "--out", str(folder)], folder, first_s, in_checkpoint)]
    if number % 5 == 4:
        second_s = dice.uniform(first_s, longest_s)
        moments.append(_killed(["resume", str(folder)], folder, second_s, in_checkpoint))
    if not (folder / "result.json").exists():
        _wait(_start("resume", str(folder), "--headless"))
    return moments


def _killed(command: list[str], folder: Path, moment_s: float, in_checkpoint: bool) -> str:
    """Start, kill at about a mission time (or while the next checkpoint is written), and say what it was."""
    process = _start(*command, "--headless")
    while process.poll() is None and _mission_time_s(folder) < moment_s:
        time.sleep(_POLL_S)
    while in_checkpoint and process.poll() is None and not list(folder.glob("checkpoint/.unfinished-*")):
        time.sleep(_POLL_S)
    if process.poll() is not None:
        return "(ended)"
    process.send_signal(signal.SIGKILL)
    process.wait()
    torn = "*" if list(folder.glob("checkpoint/.unfinished-*")) else ""
    return f"{read_recording(folder / RECORDING).duration_s:.1f} s{torn}"


def _mission_time_s(folder: Path) -> float:
    """To the second; -1 before the first."""
    recent = read_recent(folder / CHECKPOINTS)
    return -1.0 if recent is None else recent.tick / _TREE_HZ


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


def _words(figures: _Figures) -> str:
    return (
        f"{figures.outcome}, {figures.coverage:.2%}, ATE {1000 * figures.ate_m:.1f} mm, "
        f"{figures.way_m:.1f} m, {figures.time_s:.0f} s"
    )


if __name__ == "__main__":
    sys.exit(main())
