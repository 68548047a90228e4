"""The files of a map that was made from a log: the same as a mission's."""

from __future__ import annotations

import json
from pathlib import Path

from explore_bt.files import write_whole
from explore_bt.interfaces import Event, RobotProduct, RobotSnapshot, RunInfo, Slam, TickSnapshot
from explore_bt.plugin import Registry
from explore_bt.report.report_sink import ReportSink
from explore_bt.runtime import Mapping, export
from explore_bt.types import (
    Estimate,
    Health,
    MappingResult,
    MotionState,
    OccupancyGrid,
    Pose2,
    Score,
    Trajectory,
    way_along,
)

__all__ = ["write_mapping"]

_ROBOT = "robot"


def write_mapping(
    registry: Registry, mapping: Mapping, slam: Slam, result: MappingResult, folder: Path, radius_m: float
) -> None:
    """Map, trajectory (with the log's own stamps), report, and ``result.json`` last: each whole or not there.

    Raises:
        OSError: the folder cannot be made or written.
    """
    folder.mkdir(parents=True, exist_ok=True)
    grid, way = slam.grid(), slam.trajectory()
    product = RobotProduct(_ROBOT, grid, mapping.in_log_time(way), None, result, slam.structure())
    export(registry, product, slam, folder)
    _report(mapping, grid, way, result, folder, radius_m)
    write_whole(folder / "result.json", json.dumps(result.as_dict(), indent=2) + "\n")


def _report(
    mapping: Mapping,
    grid: OccupancyGrid,
    way: Trajectory,
    result: MappingResult,
    folder: Path,
    radius_m: float,
) -> None:
    """The final trajectory shown to the report's sink, a tick a pose, on the final map."""
    sink = ReportSink(ReportSink.Options())
    sink.open(RunInfo(result.mission, "", "", 0, result.version, folder, {_ROBOT: ()}, {_ROBOT: radius_m}))
    for index, (stamp_s, pose, way_m) in enumerate(
        zip(way.stamps_s.tolist(), way.poses.tolist(), way_along(way.poses).tolist(), strict=True)
    ):
        sink.on_tick(TickSnapshot(index, stamp_s, (_snapshot(stamp_s, Pose2(*pose), way_m, grid),)))
    for change in mapping.health:
        level = "info" if change.state is Health.OK else "warning"
        words = f"{change.state}: {change.reason}" if change.reason else str(change.state)
        sink.on_event(Event(change.stamp_s, _ROBOT, level, "slam", words))
    for note in (*result.notes, *filter(None, [mapping.damage])):
        sink.on_event(Event(mapping.duration_s, _ROBOT, "warning", "log", note))
    sink.close(result)


def _snapshot(stamp_s: float, pose: Pose2, way_m: float, grid: OccupancyGrid) -> RobotSnapshot:
    return RobotSnapshot(
        robot=_ROBOT,
        estimate=Estimate(stamp_s, pose),
        grid=grid,
        scan=None,
        path=None,
        motion=MotionState(),
        gate_reason="",
        nodes=(),
        blackboard={},
        score=Score(distance_m=way_m),
    )
