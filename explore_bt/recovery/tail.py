"""What was recorded of a robot after its last checkpoint."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from explore_bt.checkpoint import RobotMemory
from explore_bt.recording import Recording, decode_measurements, decode_pose
from explore_bt.recovery.messages import score_of
from explore_bt.runtime import sort_of
from explore_bt.types import Measurement, Pose2, Score, Trajectory

__all__ = ["Tail", "tail_of"]

_FAULTS = (KeyError, TypeError, ValueError, IndexError)


@dataclass(frozen=True, slots=True, eq=False)
class Tail:
    """Up to the last chunk that was closed.

    Attributes:
        measured: what SLAM was given.
        pose, true_pose, score: the last ones; None where nothing was recorded.
        true_way: the true poses.
    """

    measured: tuple[Measurement, ...] = ()
    pose: Pose2 | None = None
    true_pose: Pose2 | None = None
    score: Score | None = None
    true_way: Trajectory | None = None


def tail_of(recording: Recording, robot: str, memory: RobotMemory, since_s: float) -> Tail:
    """Everything after the checkpoint that ``memory`` belongs to.

    Args:
        recording: whole or cut.
        robot: its name.
        memory: of the checkpoint.
        since_s: mission time of the checkpoint.
    """
    way = [
        (message.stamp_s, decode_pose(message.value["pose"]))
        for message in recording.messages(f"/{robot}/truth", since_s)
        if message.stamp_s > since_s
    ]
    poses = [decode_pose(each.value["pose"]) for each in recording.messages(f"/{robot}/pose", since_s)]
    states = [each.value for each in recording.messages(f"/{robot}/state", since_s) if each.stamp_s > since_s]
    return Tail(
        measured=tuple(_measured(recording, robot, memory.heard, since_s)),
        pose=poses[-1] if poses else None,
        true_pose=way[-1][1] if way else None,
        score=score_of(states[-1]) if states else None,
        true_way=_trajectory(way),
    )


def _measured(
    recording: Recording, robot: str, heard: Mapping[str, float], since_s: float
) -> list[Measurement]:
    """Those that SLAM had not heard; damaged ones and all that follow are left out."""
    found: list[Measurement] = []
    for message in recording.messages(f"/{robot}/measured", since_s):
        try:
            found += decode_measurements(message.value)
        except _FAULTS:
            break
    return [each for each in found if each.stamp_s > heard.get(sort_of(each), -np.inf)]


def _trajectory(way: list[tuple[float, Pose2]]) -> Trajectory | None:
    if not way:
        return None
    stamps_s, poses = zip(*way, strict=True)
    return Trajectory(np.array(stamps_s), np.array([pose.as_array() for pose in poses]))
