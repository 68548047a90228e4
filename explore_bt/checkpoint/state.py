"""What is kept of a run, and of each of its robots."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from explore_bt.types import Pose2

__all__ = ["Origin", "RobotMemory", "RunMemory"]


@dataclass(frozen=True, slots=True)
class Origin:
    """Where a run came from: enough to load the very same mission again.

    Attributes:
        mission: real path of the mission file.
        files: real path -> text, of the mission and all it includes, as they were when the run began.
        settings: ``name=value`` of every ``--set``; ``folder`` is what relative files in them relate to.
        sha256: ``Mission.sha256``.
        version: of explore-bt, which began the run.
        robot: the one that the run drives of a fleet; empty for all.
        pace: simulated seconds a second that robot is held to.
    """

    mission: str
    files: Mapping[str, str]
    settings: tuple[str, ...]
    folder: str
    sha256: str
    seed: int
    version: str
    robot: str = ""
    pace: float = 1.0


@dataclass(frozen=True, slots=True)
class RunMemory:
    """The run as a whole.

    Attributes:
        tick: of the tree, the number of the next one; ``stamp_s`` the mission time of the last.
        wall_time_s: spent so far.
        ended: robot -> status of its tree, where that has ended.
        outcome, reason: how the run ended; empty while it goes on.
        parts: how many processes have worked on it.
    """

    origin: Origin
    tick: int
    stamp_s: float
    wall_time_s: float
    ended: Mapping[str, str] = field(default_factory=dict)
    outcome: str = ""
    reason: str = ""
    parts: int = 1


@dataclass(frozen=True, slots=True)
class RobotMemory:
    """One robot; its SLAM keeps itself, in a folder beside this.

    Attributes:
        home: where the mission began, ``map`` frame.
        pose: where SLAM believes the robot; ``true_pose`` where the simulator knows it.
        poses_before: how much of SLAM's trajectory a loaded map brought along.
        heard: kind and frame of a measurement -> stamp of the last that SLAM was given, seconds.
        blackboard: key -> value.
        nodes: path of a node of the tree -> what it remembers.
        parts: name of a part of the robot (``scores``, ``purse``, ``tight places``, ``team``) -> what it
            remembers.
    """

    home: Pose2
    pose: Pose2
    true_pose: Pose2 | None
    poses_before: int
    heard: Mapping[str, float]
    blackboard: Mapping[str, object]
    nodes: Mapping[str, Mapping[str, object]]
    parts: Mapping[str, Mapping[str, object]]
