"""What does the recording of a mission cost?  python benchmarks/recording.py [--mission FILE] [--seed S].

Runs the mission with true poses in place of SLAM, keeps what observers are shown, and gives it to the
recorder again, several times: its own CPU, without what the run beside it does. Scaled to ten minutes.
"""

from __future__ import annotations

import argparse
import tempfile
import time
from dataclasses import replace
from pathlib import Path

from machine import ROOT, describe_machine

from explore_bt.interfaces import API_VERSION, Event, PluginOptions, RunInfo, Sink, TickSnapshot
from explore_bt.mission import load_mission
from explore_bt.plugin import load_plugins
from explore_bt.recording import McapRecorder
from explore_bt.runtime import StopFlag, run_mission
from explore_bt.types import Result

ROUNDS = 5


class Shown(Sink):
    """Keeps all that observers are shown."""

    name = "shown"
    api_version = API_VERSION

    def __init__(self) -> None:
        super().__init__(PluginOptions())
        self.news: list[TickSnapshot | Event] = []
        self.result: Result | None = None

    def open(self, run: RunInfo) -> None:
        """The run begins."""
        self.run = run

    def on_tick(self, tick: TickSnapshot) -> None:
        """A tick has ended."""
        self.news.append(tick)

    def on_event(self, event: Event) -> None:
        """Something happened."""
        self.news.append(event)

    def close(self, result: Result | None) -> None:
        """The run is over."""
        self.result = result

    def record(self, folder: Path, options: PluginOptions) -> float:
        """Record it all; CPU seconds."""
        recorder = McapRecorder(options)
        begun = time.process_time()
        recorder.open(replace(self.run, folder=folder))
        for each in self.news:
            if isinstance(each, TickSnapshot):
                recorder.on_tick(each)
            else:
                recorder.on_event(each)
        recorder.close(self.result)
        return time.process_time() - begun


def main() -> None:
    """One mission, one row."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--mission", type=Path, default=ROOT / "missions" / "01_apartment.yaml")
    parser.add_argument("--seed", type=int, default=0)
    arguments = parser.parse_args()
    registry, shown = load_plugins().registry, Shown()
    mission = load_mission(arguments.mission, registry, ["slam=ground_truth"])
    with tempfile.TemporaryDirectory() as name:
        folder, stop = Path(name), StopFlag()
        result = run_mission(
            mission, registry=registry, out=folder, seed=arguments.seed, sinks=[shown], stop=stop
        )
        spent_s = sorted(shown.record(folder, McapRecorder.Options()) for _ in range(ROUNDS))
        size_mb = (folder / "recording.mcap").stat().st_size / 1e6
    scale = 600.0 / result.mission_time_s
    print(f"{arguments.mission.stem}, seed {arguments.seed}, {ROUNDS} times; {describe_machine()}\n")
    print("| mission time | size of 10 min | CPU of 10 min |\n|---|---|---|")
    fastest_s, slowest_s = scale * spent_s[0], scale * spent_s[-1]
    print(f"| {result.mission_time_s:.0f} s | {scale * size_mb:.1f} MB | {fastest_s:.2f}–{slowest_s:.2f} s |")


if __name__ == "__main__":
    main()
