"""What is to be compared of one run, read from its folder or from its recording."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from explore_bt.errors import UserError
from explore_bt.files import RECORDING
from explore_bt.maps import read_map
from explore_bt.recording import Recording, RecordingError, read_recording
from explore_bt.recovery import recorded_map, recorded_result, recorded_way
from explore_bt.report import cropped, overlaid
from explore_bt.types import OccupancyGrid

__all__ = ["RunFacts", "read_run"]

_MOST_POSES = 1500


@dataclass(frozen=True, slots=True, eq=False)
class RunFacts:
    """One run.

    Attributes:
        name: by which people know it.
        result: as in ``result.json``; of a cut run as far as its recording tells.
        grid: all robots' maps in one, None without any.
        ways: robot -> (N, 2) metres, ``map`` frame, thinned.
        damage: empty, or how the recording was cut off.
    """

    name: str
    folder: Path
    result: Mapping[str, Any]
    grid: OccupancyGrid | None
    ways: Mapping[str, NDArray[np.float64]]
    damage: str


def read_run(path: Path) -> RunFacts:
    """The facts of a run folder, or of a recording alone.

    Raises:
        UserError: nothing there tells of a run.
    """
    folder = path if path.is_dir() else path.parent
    result = _result(folder) if path.is_dir() else None
    recording = _recording(path / RECORDING if path.is_dir() else path, is_needed=result is None)
    if result is None or _is_older(result, recording):
        assert recording is not None  # or it was raised
        result = json.loads(json.dumps(recorded_result(recording).as_dict()))
    robots = recording.robots if recording is not None else ("robot",)
    maps = [_map(folder if path.is_dir() else None, robot, recording) for robot in robots]
    grids = [grid for grid in maps if grid is not None and grid.cells.size]
    return RunFacts(
        name=path.name or str(path.resolve().name),
        folder=folder,
        result=result,
        grid=cropped(overlaid(grids)) if grids else None,
        ways=_ways(folder if path.is_dir() else None, recording),
        damage=recording.damage if recording is not None else "",
    )


def _result(folder: Path) -> dict[str, Any] | None:
    file = folder / "result.json"
    if not file.is_file():
        return None
    try:
        found = json.loads(file.read_bytes())
    except (OSError, ValueError) as fault:
        raise UserError(
            f"{file} cannot be read: {fault}; explore-bt recover {folder} writes it anew"
        ) from None
    if not isinstance(found, dict) or "outcome" not in found:
        raise UserError(f"{file} is not the result of a run")
    return found


def _is_older(result: Mapping[str, Any], recording: Recording | None) -> bool:
    """Whether the result is of a part that was stopped, and the one after it was cut off."""
    return (
        recording is not None
        and bool(recording.damage)
        and recording.duration_s > float(result.get("mission_time_s") or 0.0) + 1.0
    )


def _recording(file: Path, *, is_needed: bool) -> Recording | None:
    try:
        return read_recording(file)
    except RecordingError as fault:
        if is_needed:
            raise UserError(f"{file.parent} is no run folder: it has no result.json, and {fault}") from None
        return None


def _map(folder: Path | None, robot: str, recording: Recording | None) -> OccupancyGrid | None:
    for file in (folder / "map.yaml", folder / robot / "map.yaml") if folder else ():
        if file.is_file():
            return read_map(file)
    return recorded_map(recording, robot) if recording is not None else None


def _ways(folder: Path | None, recording: Recording | None) -> dict[str, NDArray[np.float64]]:
    robots = recording.robots if recording is not None else ("robot",)
    ways = {}
    for robot in robots:
        way = _saved_way(folder, robot)
        if way is None and recording is not None:
            recorded = recorded_way(recording, f"/{robot}/pose")
            way = None if recorded is None else recorded.poses[:, :2]
        if way is not None and len(way):
            kept = np.unique(np.linspace(0, len(way) - 1, _MOST_POSES).round().astype(np.int64))
            ways[robot] = way[kept]
    return ways


def _saved_way(folder: Path | None, robot: str) -> NDArray[np.float64] | None:
    for file in (folder / "trajectory.tum", folder / robot / "trajectory.tum") if folder else ():
        if file.is_file() and file.stat().st_size:
            try:
                return np.loadtxt(file, ndmin=2)[:, 1:3]
            except (ValueError, IndexError):
                raise UserError(f"{file} is not a trajectory in TUM format") from None
    return None
