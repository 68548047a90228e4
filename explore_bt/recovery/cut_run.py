"""A run folder whose run broke off, and what it takes to go on."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from explore_bt.checkpoint import (
    Checkpoint,
    CheckpointError,
    CheckpointStore,
    Codec,
    CodecError,
    Recent,
    RobotMemory,
    RunMemory,
    read_recent,
)
from explore_bt.errors import MissionError, UserError
from explore_bt.files import RECORDING
from explore_bt.interfaces import Resumption
from explore_bt.mission import Mission, load_mission, only_robot
from explore_bt.plugin import Registry, load_plugins
from explore_bt.recording import Recording, RecordingError, read_recording
from explore_bt.recovery.moments import moments_of
from explore_bt.recovery.tail import Tail, tail_of
from explore_bt.runtime import (
    CHECKPOINTS,
    ENDING_KEYS,
    RUN_FILE,
    Cut,
    CutRun,
    codec_for,
    robot_file,
    run_codec,
    slam_folder,
)
from explore_bt.types import Outcome
from explore_bt.version import __version__

__all__ = ["BrokenOff", "find_broken_off"]

_NOT_BEFORE = 1e-6
_AHEAD_S = 1.5
_NOTHING_LEARNT = {"first": None, "last": None}


@dataclass(frozen=True, slots=True, eq=False)
class BrokenOff:
    """Ready to go on.

    Attributes:
        notes: what its owner should know, one sentence each: what has changed, what could not be used.
        recording: what was recorded; None if nothing of it can be read.
    """

    folder: Path
    mission: Mission
    registry: Registry
    run: CutRun
    recording: Recording | None
    notes: tuple[str, ...]


def find_broken_off(folder: Path, settings: Sequence[str] = ()) -> BrokenOff:
    """What is needed to go on with the run in ``folder``.

    Args:
        folder: of the run.
        settings: further overrides, ``name=value``; they take the place of those the run began with.

    Raises:
        UserError: it is no run folder, its run has come to its end, or no checkpoint of it is whole.
    """
    checkpoint, notes = _checkpoint(folder)
    memory = _run_memory(checkpoint)
    _check_open(folder, memory, settings)
    mission, registry, changes = _mission(memory, settings)
    recording, lost = _recording(folder, memory)
    tick = memory.tick
    if recording is not None:
        tick = max(tick, math.ceil(recording.duration_s * mission.tree_rate_hz - _NOT_BEFORE))
    recent = read_recent(checkpoint.folder.parent)
    ahead = (
        _AHEAD_S * mission.tree_rate_hz
    )  # of a recording that was lost it would know what the map does not
    if recent is not None and not memory.tick <= recent.tick <= tick + ahead:
        recent = None
    robots = {robot.name: _robot_memory(checkpoint, mission, robot.name, recent) for robot in mission.robots}
    cuts = {
        name: _cut(checkpoint, name, robot, memory, recording, tick / mission.tree_rate_hz)
        for name, robot in robots.items()
    }
    past = (lambda _: moments_of(recording)) if recording is not None else (lambda _: ())
    # so that it can be resumed a second time with what was set for the first
    origin = replace(memory.origin, settings=mission.settings, sha256=mission.sha256)
    run = CutRun(replace(memory, origin=origin), tick, cuts, past)
    return BrokenOff(folder, mission, registry, run, recording, (*notes, *changes, *lost))


def _checkpoint(folder: Path) -> tuple[Checkpoint, list[str]]:
    if not folder.is_dir():
        raise UserError(f"{folder} is no run folder; give one, for example runs/apartment-20250101-120000")
    try:
        return CheckpointStore(folder / CHECKPOINTS).newest()
    except CheckpointError as fault:
        ended = _result(folder)
        if ended.get("outcome") == Outcome.EXPLORED:
            raise UserError(
                f"{folder}: nothing left to resume, the run came to its end: {ended.get('reason')}"
            ) from None
        if not (folder / RECORDING).exists() and not ended:
            raise UserError(f"{folder} is no run folder: there is no {RECORDING} in it") from None
        raise CheckpointError(
            f"{fault}. What was recorded is not lost: explore-bt recover {folder}"
        ) from None


def _result(folder: Path) -> dict[str, object]:
    try:
        found = json.loads((folder / "result.json").read_bytes())
    except (OSError, ValueError):
        return {}
    return found if isinstance(found, dict) else {}


def _run_memory(checkpoint: Checkpoint) -> RunMemory:
    try:
        memory = run_codec().loads(checkpoint.read(RUN_FILE))
    except (CodecError, OSError) as fault:
        raise CheckpointError(f"{checkpoint.folder}/{RUN_FILE} cannot be read: {fault}") from None
    if not isinstance(memory, RunMemory):
        raise CheckpointError(f"{checkpoint.folder}/{RUN_FILE} tells of no run")
    return memory


def _check_open(folder: Path, memory: RunMemory, settings: Sequence[str]) -> None:
    """Refuse a run that has nothing left to do, or nothing left to do it with."""
    if memory.outcome == Outcome.EXPLORED:
        raise UserError(f"{folder}: nothing left to resume, the run came to its end: {memory.reason}")
    if memory.outcome == Outcome.BUDGET and not any(each.startswith("limits.") for each in settings):
        raise UserError(
            f"{folder}: {memory.reason}; to go on give it more in all, "
            "for example --set limits.time='40 min' or --set limits.distance='200 m'"
        )


def _mission(memory: RunMemory, settings: Sequence[str]) -> tuple[Mission, Registry, list[str]]:
    """The mission as it was when the run began, and what has changed since."""
    origin, notes = memory.origin, []
    path = Path(origin.mission)
    registry = load_plugins(inline_dir=path.parent).registry
    texts = {Path(name): text for name, text in origin.files.items()}
    changed = [file for file, text in texts.items() if not _is_still(file, text)]
    if changed:
        names = ", ".join(file.name for file in changed)
        notes.append(f"{names} changed since the run began; it goes on with the mission as it was then")
    given = {each.partition("=")[0].strip(): each for each in (*origin.settings, *settings)}
    mission = load_mission(path, registry, tuple(given.values()), Path(origin.folder), texts=texts)
    if mission.sha256 != origin.sha256:
        if not settings:
            raise MissionError(
                f"{path}: the parameters are not those the run began with; a $env value has changed, "
                "set it as it was"
            )
        notes.append("it goes on with other parameters than it began with")
    if origin.version != __version__:
        notes.append(f"it was begun by explore-bt {origin.version}, this is {__version__}")
    if origin.robot:
        mission = only_robot(mission, origin.robot, origin.pace)
    return mission, registry, notes


def _is_still(file: Path, text: str) -> bool:
    try:
        return file.read_bytes().decode("utf-8-sig") == text
    except (OSError, ValueError):
        return False


def _recording(folder: Path, memory: RunMemory) -> tuple[Recording | None, list[str]]:
    try:
        recording = read_recording(folder / RECORDING)
    except RecordingError as fault:
        return None, [f"what was recorded before is lost: {fault}"]
    origin, info = memory.origin, recording.info
    if (info.get("mission_text"), info.get("seed")) != (origin.files.get(origin.mission), origin.seed):
        return None, [f"{folder / RECORDING} belongs to another run; it is not used, and will be replaced"]
    return recording, []


def _robot_memory(checkpoint: Checkpoint, mission: Mission, name: str, recent: Recent | None) -> RobotMemory:
    """As in the checkpoint, with what the robot had in mind a second before the end."""
    tree = next(robot.tree for robot in mission.robots if robot.name == name)
    leaves = [node.leaf for node in tree.walk() if node.leaf is not None]
    file, codec = robot_file(name), codec_for(leaves)
    try:
        memory = codec.loads(checkpoint.read(file))
    except (CodecError, OSError) as fault:
        raise CheckpointError(f"{checkpoint.folder / file} cannot be read: {fault}") from None
    if not isinstance(memory, RobotMemory):
        raise CheckpointError(f"{checkpoint.folder / file} tells of no robot")
    newer = _recent_memory(codec, recent, name) or memory
    return replace(
        memory, blackboard=newer.blackboard, nodes=newer.nodes, parts={**memory.parts, **newer.parts}
    )


def _recent_memory(codec: Codec, recent: Recent | None, name: str) -> RobotMemory | None:
    """None where nothing of use was written after the checkpoint."""
    try:
        found = codec.loads(recent.robots[name]) if recent and name in recent.robots else None
    except CodecError:
        return None
    return found if isinstance(found, RobotMemory) else None


def _cut(
    checkpoint: Checkpoint,
    name: str,
    memory: RobotMemory,
    run: RunMemory,
    recording: Recording | None,
    stamp_s: float,
) -> Cut:
    tail = tail_of(recording, name, memory, run.stamp_s) if recording is not None else Tail()
    board = {
        key: value for key, value in memory.blackboard.items() if not run.outcome or key not in ENDING_KEYS
    }
    parts = dict(memory.parts)
    if run.outcome == Outcome.BUDGET:
        parts["purse"] = _NOTHING_LEARNT  # the battery may be another one
    return Cut(
        resumption=Resumption(
            stamp_s, tail.pose or memory.pose, tail.true_pose or memory.true_pose, run.parts + 1
        ),
        memory=replace(memory, blackboard=board, parts=parts),
        slam_folder=checkpoint.folder / slam_folder(name),
        measured=tail.measured,
        score=tail.score,
        true_way=tail.true_way,
    )
