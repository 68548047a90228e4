"""A mission in a small world, whose folder is copied in the middle: what a killed process leaves."""

from __future__ import annotations

import shutil
import textwrap
from collections.abc import Callable
from pathlib import Path

import pytest

from explore_bt.interfaces import PluginOptions, RunInfo, Sink, TickSnapshot
from explore_bt.mission import load_mission
from explore_bt.plugin import load_plugins
from explore_bt.recording import McapRecorder
from explore_bt.report import ReportSink
from explore_bt.runtime import StopFlag, run_mission
from explore_bt.types import Result

WORLD = """
    format: explore-bt-world/1
    name: two rooms
    start: [1.0, 1.5, 0 deg]
    rooms:
      - {name: left, box: [0.0, 0.0, 3.0, 3.0]}
      - {name: right, box: [3.0, 0.0, 6.0, 3.0]}
    doors:
      - {name: door, at: [3.0, 1.5], width: 1.2}
"""

MISSION = """
    format: explore-bt/1
    name: rooms
    params:
      pause: {type: duration, default: 0.5 s}
    robots:
      robot:
        driver: {use: sim2d, world: world.yaml, battery_life: 10 min}
        slam: {use: kiss_gtsam}
        planner: {use: skeleton}
        controller: {use: pursuit}
    limits: {time: 3 min, battery: 0.1}
    include: [trees.yaml]
    tree: main
"""

TREES = """
    format: explore-bt/1
    trees:
      main:
        sequence:
          - wait: {duration: $params.pause}
          - record_waypoint: {place: here}
          - force_success:
              repeat:
                times: forever
                child:
                  sequence:
                    - find_view
                    - drive_to
                    - record_waypoint
          - choose_home
          - drive_to
"""


class CutAt(Sink):
    """Copies the run folder when a tick of this number has been recorded."""

    name = "cut_at"
    api_version = 1

    def __init__(self, tick: int, copy: Path) -> None:
        super().__init__(PluginOptions())
        self._tick, self._copy = tick, copy

    def open(self, run: RunInfo) -> None:
        self._folder = run.folder

    def on_tick(self, tick: TickSnapshot) -> None:
        if tick.index == self._tick:
            shutil.copytree(self._folder, self._copy)

    def close(self, result: Result | None) -> None: ...


RunRooms = Callable[..., Result]


@pytest.fixture(scope="session")
def mission(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("mission")
    for name, text in (("world.yaml", WORLD), ("rooms.yaml", MISSION), ("trees.yaml", TREES)):
        (folder / name).write_text(textwrap.dedent(text))
    return folder / "rooms.yaml"


def drive(mission: Path, out: Path, *settings: str, cut: CutAt | None = None, stop_at: float = 0.0) -> Result:
    registry = load_plugins().registry
    stop = StopFlag()
    sinks: list[Sink] = [McapRecorder(McapRecorder.Options()), ReportSink(ReportSink.Options())]
    sinks += [cut] if cut else []
    if stop_at:
        sinks.append(_StopAt(stop_at, stop))
    return run_mission(
        load_mission(mission, registry, settings), registry=registry, out=out, seed=2, sinks=sinks, stop=stop
    )


class _StopAt(CutAt):
    """Presses Ctrl-C at a mission time."""

    name = "stop_at"

    def __init__(self, stamp_s: float, stop: StopFlag) -> None:
        super().__init__(-1, Path())
        self._stamp_s, self._stop = stamp_s, stop

    def on_tick(self, tick: TickSnapshot) -> None:
        if tick.stamp_s >= self._stamp_s:
            self._stop.raise_flag("stopped by hand (Ctrl-C)")


@pytest.fixture(scope="session")
def runs(mission: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """``whole``: a run to its end; ``cut``: what a kill at 13.3 s leaves of it. Do not change them."""
    folder = tmp_path_factory.mktemp("runs")
    drive(mission, folder / "whole", cut=CutAt(132, folder / "cut"))
    return folder


@pytest.fixture
def cut(runs: Path, tmp_path: Path) -> Path:
    """A cut run of one's own."""
    return Path(shutil.copytree(runs / "cut", tmp_path / "cut"))
