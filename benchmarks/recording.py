"""What does the recording of a mission cost?  python benchmarks/recording.py [--mission FILE] [--seed S].

Runs the mission with true poses in place of SLAM and times the recorder's own CPU; scaled to ten minutes.
"""

from __future__ import annotations

import argparse
import tempfile
import time
from pathlib import Path

from machine import ROOT, describe_machine

from explore_bt.interfaces import Event, PluginOptions, RunInfo, TickSnapshot
from explore_bt.mission import load_mission
from explore_bt.plugin import load_plugins
from explore_bt.recording import McapRecorder
from explore_bt.runtime import StopFlag, run_mission
from explore_bt.types import Result


class TimedRecorder(McapRecorder):
    """Counts its own CPU time."""

    def __init__(self, options: PluginOptions) -> None:
        super().__init__(options)
        self.spent_s = 0.0

    def open(self, run: RunInfo) -> None:
        """The run begins."""
        begun = time.process_time()
        super().open(run)
        self.spent_s += time.process_time() - begun

    def on_tick(self, tick: TickSnapshot) -> None:
        """A tick has ended."""
        begun = time.process_time()
        super().on_tick(tick)
        self.spent_s += time.process_time() - begun

    def on_event(self, event: Event) -> None:
        """Something happened."""
        begun = time.process_time()
        super().on_event(event)
        self.spent_s += time.process_time() - begun

    def close(self, result: Result | None) -> None:
        """The run is over."""
        begun = time.process_time()
        super().close(result)
        self.spent_s += time.process_time() - begun


def main() -> None:
    """One mission, one row."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--mission", type=Path, default=ROOT / "missions" / "01_apartment.yaml")
    parser.add_argument("--seed", type=int, default=0)
    arguments = parser.parse_args()
    registry = load_plugins().registry
    recorder = TimedRecorder(McapRecorder.Options())
    mission = load_mission(arguments.mission, registry, ["slam=ground_truth"])
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name) / "run"
        result = run_mission(
            mission,
            registry=registry,
            out=folder,
            seed=arguments.seed,
            sinks=[recorder],
            stop=StopFlag(),
        )
        size_mb = (folder / "recording.mcap").stat().st_size / 1e6
    scale = 600.0 / result.mission_time_s
    print(f"{arguments.mission.stem}, seed {arguments.seed}; {describe_machine()}\n")
    print("| mission time | size | CPU | size of 10 min | CPU of 10 min |\n|---|---|---|---|---|")
    print(
        f"| {result.mission_time_s:.0f} s | {size_mb:.1f} MB | {recorder.spent_s:.2f} s | "
        f"{scale * size_mb:.1f} MB | {scale * recorder.spent_s:.2f} s |"
    )


if __name__ == "__main__":
    main()
