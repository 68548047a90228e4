"""Which classes a checkpoint may hold, and what its files are called."""

from __future__ import annotations

from collections.abc import Iterable

from explore_bt.checkpoint import Codec, Origin, RobotMemory, RunMemory
from explore_bt.tree import Leaf
from explore_bt.types import (
    Battery,
    Budget,
    GridWindow,
    Health,
    MotionState,
    MovingObstacle,
    Outcome,
    Path,
    Pose2,
    Score,
    Twist2,
    Waypoint,
)

__all__ = ["RUN_FILE", "codec_for", "robot_file", "run_codec", "slam_folder"]

RUN_FILE = "run.json"

_RUN = (Origin, RunMemory)
_ROBOT = (
    RobotMemory,
    Battery,
    Budget,
    GridWindow,
    Health,
    MotionState,
    MovingObstacle,
    Outcome,
    Path,
    Pose2,
    Score,
    Twist2,
    Waypoint,
)


def run_codec() -> Codec:
    """For ``run.json``."""
    return Codec(_RUN)


def codec_for(leaves: Iterable[type[Leaf]]) -> Codec:
    """For one robot's file: the framework's own values, and those that the leaves of its tree declare."""
    declared = (cls for leaf in leaves for cls in leaf.values)
    return Codec(dict.fromkeys((*_ROBOT, *declared)))


def robot_file(name: str) -> str:
    """A robot's memory."""
    return f"{name}/memory.json"


def slam_folder(name: str) -> str:
    """What its SLAM saved."""
    return f"{name}/slam"
