"""Everything that a run left, as the files of a run that ended."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import Any

import numpy as np

from explore_bt.errors import UserError
from explore_bt.exploration import ArgumentError, ate_rmse_m
from explore_bt.files import write_whole
from explore_bt.interfaces import Event, NodeInfo, RobotContext, RobotProduct, RunInfo, Slam, TickSnapshot
from explore_bt.plugin import load_plugins
from explore_bt.recording import RECORDING, Recording, decode_grid, read_recording
from explore_bt.recovery.cut_run import BrokenOff, find_broken_off
from explore_bt.recovery.messages import number, pose_of, score_of
from explore_bt.recovery.moments import moments_of
from explore_bt.recovery.repair import repair
from explore_bt.report import ReportSink
from explore_bt.runtime import export
from explore_bt.types import OccupancyGrid, Outcome, Result, Score, Trajectory

__all__ = ["Recovered", "recover"]

_RESULT = tuple(field.name for field in fields(Result))


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
    result = _result(recording)
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
            _recorded_map(recording, name),
            _way(recording, f"/{name}/pose") or Trajectory(np.empty(0), np.empty((0, 3))),
            _way(recording, f"/{name}/truth"),
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


def _recorded_map(recording: Recording, name: str) -> OccupancyGrid:
    grid = OccupancyGrid(np.empty((0, 0), dtype=np.int8), 0.05, (0.0, 0.0))
    last = None
    for last in recording.messages(f"/{name}/map"):  # noqa: B007  # only the last one counts
        pass
    return grid if last is None else decode_grid(last.value)


def _way(recording: Recording, topic: str) -> Trajectory | None:
    rows = [(message.stamp_s, pose_of(message.value)) for message in recording.messages(topic)]
    kept = [(stamp_s, pose) for stamp_s, pose in rows if math.isfinite(pose.x + pose.y + pose.yaw_rad)]
    if not kept:
        return None
    return Trajectory(
        np.array([stamp_s for stamp_s, _ in kept]), np.array([pose.as_array() for _, pose in kept])
    )


def _result(recording: Recording) -> Result:
    """As it was recorded, or as the last state of the robots tells."""
    last = None
    for last in recording.messages("/result"):  # noqa: B007  # only the last one counts
        pass
    if last is not None and last.value.get("outcome") in set(Outcome):
        return _recorded_result(last.value)
    info = recording.info
    scores = [_last_score(recording, name) for name in recording.robots] or [Score()]
    score = scores[0]
    return Result(
        outcome=Outcome.CUT,
        reason=f"the process died; everything up to {recording.duration_s:.1f} s of mission time was saved",
        mission=str(info.get("mission", "")),
        coverage=score.coverage,
        contacts=score.contacts,
        touched_by_people=score.touched_by_people,
        ate_rmse_m=None,
        path_length_m=score.distance_m,
        mission_time_s=recording.duration_s,
        wall_time_s=0.0,
        min_clearance_m=score.min_clearance_m,
        mean_clearance_m=score.mean_clearance_m,
        distance_to_home_m=score.distance_to_home_m,
        seed=int(number(info.get("seed"), 0.0)),
        mission_sha256=str(info.get("mission_sha256", "")),
        version=str(info.get("version", "")),
    )


def _recorded_result(value: Mapping[str, Any]) -> Result:
    known = {name: value[name] for name in _RESULT if name in value}
    known["outcome"] = Outcome(value["outcome"])
    known["left_open"] = tuple(value.get("left_open", ()))
    return Result(**{"wall_time_s": 0.0, **known})


def _last_score(recording: Recording, name: str) -> Score:
    score = Score()
    for message in recording.messages(f"/{name}/state", max(recording.duration_s - 10.0, 0.0)):
        score = score_of(message.value)
    return score


def _with_slam(result: Result, saved: _Saved) -> Result:
    """With SLAM's figures, and the error of its trajectory where the truth is known."""
    figures = dict(saved.slam.figures()) if saved.slam is not None else result.slam
    error_m = result.ate_rmse_m
    if saved.truth is not None and error_m is None:
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
