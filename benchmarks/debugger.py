"""What does an attached debugger cost a run that goes on freely?  python benchmarks/debugger.py [--runs N].

The same mission is driven alone, with a debugger that watches nothing, and with one whose breakpoints are
looked at but never stop the run; in turn, so that the machine's moods fall on all. The runs decide the
same, tick by tick, so each tick's time is the least of its runs. A tick is everything between two of them:
simulation, SLAM, control, tree, recording. Deciding is the tree alone. Times are CPU of the tick's thread.
"""

from __future__ import annotations

import argparse
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from statistics import median

import numpy as np
from machine import ROOT, describe_machine

from explore_bt.debug import AddBreakpoint, Breakpoint, DebugSession, History
from explore_bt.interfaces import Sink, TickSnapshot
from explore_bt.mission import load_mission
from explore_bt.plugin import load_plugins
from explore_bt.recording import McapRecorder
from explore_bt.runtime import Attendant, Robot, Runner, StopFlag, run_mission
from explore_bt.tree import Status

WATCHED = (
    Breakpoint("drive_to", condition="$goal.pose.x > 1000 and speed > 0.1"),
    Breakpoint("*", status="failure", condition="time < 0"),
    Breakpoint("find_*", condition="coverage > 2"),
)


class _Times:
    """CPU seconds of every tick, of deciding in it, and of what the debugger does between two ticks."""

    def __init__(self) -> None:
        self.ticks: list[float] = []
        self.own: list[float] = []
        self.decisions: list[float] = []
        self._last = 0.0

    def begin(self, runner: Runner) -> None:
        self._last = time.thread_time()
        for robot in runner.robots:
            self._clock(robot)

    def on_period(self) -> None:
        now = time.thread_time()
        self.ticks.append(now - self._last)
        self._last = now

    def _clock(self, robot: Robot) -> None:
        decide = robot.decide

        def timed() -> Status:
            begun = time.thread_time()
            status = decide()
            self.decisions.append(time.thread_time() - begun)
            return status

        robot.decide = timed  # type: ignore[method-assign]  # to look at it from outside is the point


class Alone(Attendant):
    """Nobody."""

    def __init__(self) -> None:
        self.times = _Times()

    def begin(self, runner: Runner) -> None:
        """Start the clock."""
        self.times.begin(runner)

    def on_period(self) -> None:
        """A tick has passed."""
        self.times.on_period()


class Attached(DebugSession):
    """A debugger; a client listens and asks for nothing."""

    def __init__(self, *, watches: bool = False) -> None:
        super().__init__()
        self.times = _Times()
        self._watches = watches

    def begin(self, runner: Runner) -> None:
        """Set the breakpoints, start the clock."""
        super().begin(runner)
        self.subscribe(lambda _: None)
        for each in WATCHED if self._watches else ():
            self.submit(AddBreakpoint(each))
        self.times.begin(runner)

    def on_period(self) -> None:
        """A tick has passed."""
        begun = time.thread_time()
        super().on_period()
        self.times.own.append(time.thread_time() - begun)
        self.times.on_period()


class TimedHistory(History):
    """Counts its own CPU time too."""

    def __init__(self, times: _Times) -> None:
        super().__init__()
        self._times = times

    def on_tick(self, tick: TickSnapshot) -> None:
        """Keep it."""
        begun = time.thread_time()
        super().on_tick(tick)
        self._times.own[-1] += time.thread_time() - begun


CASES: dict[str, Callable[[], Alone | Attached]] = {
    "no debugger": Alone,
    "attached, nothing to watch": Attached,
    "attached, 3 conditional breakpoints": lambda: Attached(watches=True),
    "no debugger, once more": Alone,  # how far two equal cases differ on this machine
}


def main() -> None:
    """All cases in turn, a row each."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--mission", type=Path, default=ROOT / "missions" / "00_room.yaml")
    parser.add_argument("--runs", type=int, default=5)
    parser.add_argument("--seed", type=int, default=0)
    arguments = parser.parse_args()
    found: dict[str, list[_Times]] = {name: [] for name in CASES}
    for _ in range(arguments.runs):
        for name, make in CASES.items():
            found[name].append(_drive(arguments.mission, arguments.seed, make()))
    print(f"{arguments.mission.stem}, {arguments.runs} runs each; {describe_machine()}\n")
    print("| | tick, median | sum of ticks | deciding, median | sum of deciding | commands and history |")
    print("|---|---|---|---|---|---|")
    base = _sums(found["no debugger"])
    for name, runs in found.items():
        ticks, decisions = _least(runs, "ticks"), _least(runs, "decisions")
        sums = _sums(runs)
        print(
            f"| {name} | {1e3 * median(ticks):.2f} ms | {sums[0]:.2f} s ({_more(sums[0], base[0])}) "
            f"| {1e6 * median(decisions):.0f} µs | {sums[1]:.2f} s ({_more(sums[1], base[1])}) "
            f"| {_own(runs)} |"
        )


def _drive(path: Path, seed: int, attendant: Alone | Attached) -> _Times:
    registry = load_plugins().registry
    mission = load_mission(path, registry)
    sinks: list[Sink] = [McapRecorder(McapRecorder.Options())]
    if isinstance(attendant, Attached):
        sinks.append(TimedHistory(attendant.times))
    with tempfile.TemporaryDirectory() as name:
        run_mission(
            mission,
            registry=registry,
            out=Path(name) / "run",
            seed=seed,
            sinks=sinks,
            stop=StopFlag(),
            attendant=attendant,
        )
    return attendant.times


def _least(runs: list[_Times], what: str) -> list[float]:
    values: list[float] = np.min([getattr(run, what) for run in runs], axis=0).tolist()
    return values


def _sums(runs: list[_Times]) -> tuple[float, float]:
    return sum(_least(runs, "ticks")), sum(_least(runs, "decisions"))


def _own(runs: list[_Times]) -> str:
    return f"{1e6 * median(_least(runs, 'own')):.0f} µs" if runs[0].own else "–"


def _more(value: float, base: float) -> str:
    return f"{100.0 * (value / base - 1.0):+.1f} %"


if __name__ == "__main__":
    main()
