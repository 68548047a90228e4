"""The last things that a recording says about a run."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import fields
from typing import Any

import numpy as np

from explore_bt.exploration import ArgumentError, ate_rmse_m
from explore_bt.recording import Recording, decode_grid, decode_pose
from explore_bt.recovery.messages import number, score_of
from explore_bt.types import OccupancyGrid, Outcome, Result, Score, Trajectory

__all__ = ["recorded_map", "recorded_result", "recorded_way"]

_RESULT = tuple(field.name for field in fields(Result))


def recorded_map(recording: Recording, name: str) -> OccupancyGrid:
    """The last map of a robot; empty where none was recorded."""
    grid = OccupancyGrid(np.empty((0, 0), dtype=np.int8), 0.05, (0.0, 0.0))
    last = recording.last(f"/{name}/map")
    return grid if last is None else decode_grid(last.value)


def recorded_way(recording: Recording, topic: str) -> Trajectory | None:
    """The poses of a topic; None where none was recorded."""
    rows = [(message.stamp_s, decode_pose(message.value["pose"])) for message in recording.messages(topic)]
    kept = [(stamp_s, pose) for stamp_s, pose in rows if math.isfinite(pose.x + pose.y + pose.yaw_rad)]
    if not kept:
        return None
    return Trajectory(
        np.array([stamp_s for stamp_s, _ in kept]), np.array([pose.as_array() for _, pose in kept])
    )


def recorded_result(recording: Recording) -> Result:
    """As it was recorded, or as the last state of the robots tells."""
    last = recording.last("/result")
    if last is not None and last.value.get("outcome") in set(Outcome):
        return _of_message(last.value)
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
        ate_rmse_m=_error_m(recording),
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


def _error_m(recording: Recording) -> float | None:
    """Of the poses as they were believed at the time; None where the truth is not known."""
    for name in recording.robots[:1]:
        believed, true = (recorded_way(recording, f"/{name}/{topic}") for topic in ("pose", "truth"))
        if believed is not None and true is not None:
            try:
                return ate_rmse_m(believed, true)
            except ArgumentError:  # too short for the two to overlap
                return None
    return None


def _of_message(value: Mapping[str, Any]) -> Result:
    known = {name: value[name] for name in _RESULT if name in value}
    known["outcome"] = Outcome(value["outcome"])
    for name in ("left_open", "not_merged"):
        known[name] = tuple(value.get(name, ()))
    return Result(**{"wall_time_s": 0.0, **known})


def _last_score(recording: Recording, name: str) -> Score:
    last = recording.last(f"/{name}/state", max(recording.duration_s - 10.0, 0.0))
    return Score() if last is None else score_of(last.value)
