"""Runs that are cut off, in this process."""

from __future__ import annotations

import shutil
from pathlib import Path

from explore_bt.interfaces import PluginOptions, RunInfo, Sink, TickSnapshot
from explore_bt.mission import Mission, load_mission
from explore_bt.plugin import load_plugins
from explore_bt.recording import McapRecorder
from explore_bt.recovery import find_broken_off
from explore_bt.report import ReportSink
from explore_bt.runtime import CutRun, StopFlag, run_mission
from explore_bt.types import Result


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


def drive(
    mission: Path | Mission,
    out: Path,
    *settings: str,
    cut: CutAt | None = None,
    stop_at: float = 0.0,
    seed: int = 2,
) -> Result:
    """A run from its beginning; ``cut`` copies its folder on the way, ``stop_at`` presses Ctrl-C."""
    if isinstance(mission, Path):
        registry = load_plugins(inline_dir=mission.parent).registry
        mission = load_mission(mission, registry, settings)
    return _run(mission, out, None, cut, stop_at, seed)


def resume(out: Path, *settings: str, cut: CutAt | None = None, stop_at: float = 0.0) -> Result:
    """Go on with the run in ``out``."""
    broken = find_broken_off(out, settings)
    return _run(broken.mission, out, broken.run, cut, stop_at, broken.run.memory.origin.seed)


def _run(
    mission: Mission, out: Path, resumed: CutRun | None, cut: CutAt | None, stop_at: float, seed: int
) -> Result:
    stop = StopFlag()
    sinks: list[Sink] = [McapRecorder(McapRecorder.Options()), ReportSink(ReportSink.Options())]
    sinks += [cut] if cut else []
    sinks += [_StopAt(stop_at, stop)] if stop_at else []
    registry = load_plugins().registry
    return run_mission(
        mission, registry=registry, out=out, seed=seed, sinks=sinks, stop=stop, resumed=resumed
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
