"""Everything that a run left, as the files of a run that ended."""

from __future__ import annotations

import json
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from explore_bt.errors import UserError
from explore_bt.exploration import ArgumentError, ate_rmse_m
from explore_bt.files import RECORDING, write_whole
from explore_bt.interfaces import Event, NodeInfo, RobotContext, RobotProduct, RunInfo, Slam, TickSnapshot
from explore_bt.plugin import load_plugins
from explore_bt.recording import Recording, read_recording
from explore_bt.recovery.cut_run import BrokenOff, find_broken_off
from explore_bt.recovery.last_known import recorded_map, recorded_result, recorded_way
from explore_bt.recovery.messages import number
from explore_bt.recovery.moments import moments_of
from explore_bt.recovery.repair import repair
from explore_bt.report import ReportSink
from explore_bt.runtime import export
from explore_bt.types import OccupancyGrid, Result, Trajectory

__all__ = ["Recovered", "recover"]


@dataclass(frozen=True, slots=True, eq=False)
class Recovered:
    """What could be saved.

    Attributes:
        folder: where it is, laid out as a run folder.
        stamp_s: up to this mission time.
        damage: what was wrong with the recording; empty if nothing was.
        notes: what could not be used, one sentence each.
    """

    folder: Path
    result: Result
    stamp_s: float
    damage: str
    notes: tuple[str, ...]


def recover(source: Path, out: Path) -> Recovered:
    """Write recording, map, trajectory, report and result of a run that broke off into ``out``, a new folder.

    Map and trajectory are SLAM's own, from the last checkpoint and what was measured after it, where there is
    one; else those that were recorded.

    Args:
        source: a run folder, or a recording.
        out: made here; nothing in it may be of use to anybody.

    Raises:
        UserError: there is no recording, or not one second of it.
    """
    recording = read_recording(source / RECORDING if source.is_dir() else source)
    broken, notes = _broken_off(source)
    registry = broken.registry if broken else load_plugins().registry
    out.mkdir(parents=True, exist_ok=True)
    repair(recording, out / RECORDING)
    result = recorded_result(recording)
    for name in recording.robots:
        folder = out if len(recording.robots) == 1 else out / name
        folder.mkdir(exist_ok=True)
        saved = _Saved.of(recording, name, broken, notes)
        if name == recording.robots[0]:
            result = _with_slam(result, saved)
        product = RobotProduct(name, saved.grid, saved.trajectory, saved.truth, result, *saved.structure)
        export(registry, product, saved.slam, folder)
    _report(recording, result, out)
    write_whole(out / "result.json", json.dumps(result.as_dict(), indent=2) + "\n")
    return Recovered(out, result, recording.duration_s, recording.damage, tuple(notes))


def _broken_off(source: Path) -> tuple[BrokenOff | None, list[str]]:
    if not source.is_dir():
        return None, []
    try:
        broken = find_broken_off(source)
    except UserError as fault:
        return None, [f"map and trajectory are those that were recorded: {fault}"]
    return broken, list(broken.notes)


@dataclass(slots=True)
class _Saved:
    """What is known of one robot."""

    grid: OccupancyGrid
    trajectory: Trajectory
    truth: Trajectory | None
    slam: Slam | None = None

    @property
    def structure(self) -> tuple[Any, ...]:
        return () if self.slam is None else (self.slam.structure(),)

    @staticmethod
    def of(recording: Recording, name: str, broken: BrokenOff | None, notes: list[str]) -> _Saved:
        saved = _Saved(
            recorded_map(recording, name),
            recorded_way(recording, f"/{name}/pose") or Trajectory(np.empty(0), np.empty((0, 3))),
            recorded_way(recording, f"/{name}/truth"),
        )
        if broken is not None and name in broken.run.robots:
            try:
                slam = _slam(broken, name)
            except Exception as fault:  # a plugin that needs its simulator, or is not what it was
                notes.append(f"robot {name}: map and trajectory are those that were recorded: {fault}")
                return saved
            before = broken.run.robots[name].memory.poses_before
            whole = slam.trajectory()
            saved.slam, saved.grid = slam, slam.grid()
            saved.trajectory = Trajectory(whole.stamps_s[before:], whole.poses[before:])
        return saved


def _slam(broken: BrokenOff, name: str) -> Slam:
    """SLAM as it stood at the last recorded second."""
    spec = next(robot for robot in broken.mission.robots if robot.name == name)
    cut = broken.run.robots[name]
    slam = spec.slam.make()
    slam.setup(
        RobotContext(name, broken.run.memory.origin.seed, start=cut.memory.pose, resumed=cut.resumption)
    )
    slam.load(cut.slam_folder)
    for measurement in cut.measured:
        slam.update(measurement)
    return slam


def _with_slam(result: Result, saved: _Saved) -> Result:
    """With SLAM's figures, and the error of its trajectory where the truth is known."""
    figures = dict(saved.slam.figures()) if saved.slam is not None else result.slam
    error_m = result.ate_rmse_m
    if saved.truth is not None and saved.slam is not None:
        try:
            error_m = ate_rmse_m(saved.trajectory, saved.truth)
        except ArgumentError:  # too short for the two to overlap
            error_m = None
    return replace(result, slam=figures, ate_rmse_m=error_m)


def _report(recording: Recording, result: Result, out: Path) -> None:
    info = recording.info
    sink = ReportSink(ReportSink.Options())
    trees = {name: tuple(NodeInfo(**node) for node in nodes) for name, nodes in info.get("trees", {}).items()}
    radii = {name: number(radius, 0.25) for name, radius in info.get("footprint_radius_m", {}).items()}
    sink.open(
        RunInfo(
            result.mission,
            str(info.get("mission_text", "")),
            result.mission_sha256,
            result.seed,
            result.version,
            out,
            trees,
            radii,
        )
    )
    for moment in moments_of(recording):
        if isinstance(moment, TickSnapshot):
            sink.on_tick(moment)
        else:
            sink.on_event(moment)
    if recording.damage:
        sink.on_event(Event(recording.duration_s, "", "warning", "recording", recording.damage))
    sink.close(result)
