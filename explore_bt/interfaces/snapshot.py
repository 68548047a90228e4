"""What observers are shown: the run as it begins, and every tick."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path as FilePath

from explore_bt.interfaces.held_by import HeldBy
from explore_bt.types import (
    Budget,
    Doing,
    Drawing,
    Estimate,
    Measurement,
    MotionState,
    MovingObstacle,
    OccupancyGrid,
    Path,
    Pose2,
    Scan2D,
    Score,
    Twist2,
)

__all__ = [
    "Event",
    "MateFrame",
    "NodeInfo",
    "NodeState",
    "PortInfo",
    "RobotSnapshot",
    "RunInfo",
    "TickSnapshot",
]


@dataclass(frozen=True, slots=True)
class PortInfo:
    """A port of a leaf as it is wired.

    Attributes:
        bound: ``$entry`` for a blackboard entry, else the constant as a mission would write it.
        is_output: whether the leaf writes it.
    """

    name: str
    bound: str
    is_output: bool


@dataclass(frozen=True, slots=True)
class NodeInfo:
    """A node of a built tree.

    Attributes:
        id: position in depth-first order, 0 is the root; parents come before children.
        path: unique, from the root: ``complete/explore/find_next_heading``.
        type: the YAML key (``sequence``, ``find_next_heading``).
        place: ``file:line:column`` in the mission.
        is_mocked: whether a script plays in the leaf's place.
    """

    id: int
    path: str
    name: str
    type: str
    parent: int | None
    place: str
    ports: tuple[PortInfo, ...] = ()
    is_mocked: bool = False


@dataclass(frozen=True, slots=True)
class NodeState:
    """A node after a tick: ``success``, ``failure``, ``running`` or ``idle``, and its reason in words.

    Attributes:
        ticks: how often it was ticked in this tick of the tree; 0 leaves an older status standing.
        successes, failures: how often it ended so in this tick of the tree.
    """

    status: str
    message: str
    ticks: int = field(default=0, compare=False)
    successes: int = field(default=0, compare=False)
    failures: int = field(default=0, compare=False)


@dataclass(frozen=True, slots=True, eq=False)
class RunInfo:
    """All that is known when a run begins.

    Attributes:
        sources: file as ``NodeInfo.place`` names it -> its text.
        resumed_s: mission time at which a run that broke off goes on; None for one that begins.
    """

    mission: str
    mission_text: str
    mission_sha256: str
    seed: int
    version: str
    folder: FilePath
    trees: Mapping[str, tuple[NodeInfo, ...]]
    footprint_radius_m: Mapping[str, float]
    sources: Mapping[str, str] = field(default_factory=dict)
    resumed_s: float | None = None


@dataclass(frozen=True, slots=True)
class MateFrame:
    """How the map of a team mate lies in the robot's own.

    Attributes:
        T_ours_theirs: to a centimetre, about where the mate is; None while nobody knows.
        not_merged: why its map is not part of the robot's; empty if it is.
    """

    name: str
    T_ours_theirs: Pose2 | None
    not_merged: str = ""


@dataclass(frozen=True, slots=True, eq=False)
class RobotSnapshot:
    """One robot after a tick; every value is immutable.

    Attributes:
        nodes: in the order of ``RunInfo.trees[robot]``.
        blackboard: key -> value after this tick.
        gate_reason: empty while commands pass; else why the safety gate brakes.
        held_by: what kind of reason that is.
        scan_pose: where the robot was at the scan's stamp, ``map`` frame; None where nobody knows.
        scan_twist: how it moved then.
        true_pose: where the driver knows it.
        measured: what SLAM was given since the tick before, in this order.
        moving: what moves around the robot, as the newest scan tells.
        budgets: what of time, distance and battery the mission allows still.
        charge: of the battery, a share; None where nobody measures it.
        doing: what the robot is about, as its team is told.
        claims: where it goes to look, as its team is told, (x, y) in metres, ``map`` frame.
        mates: everybody of the team who has been heard, and where their maps lie.
        drawing: what the leaves saw in the last tick in which any of them decided; the same object till then.
    """

    robot: str
    estimate: Estimate
    grid: OccupancyGrid
    scan: Scan2D | None
    path: Path | None
    motion: MotionState
    gate_reason: str
    nodes: tuple[NodeState, ...]
    blackboard: Mapping[str, object]
    score: Score
    scan_pose: Pose2 | None = None
    scan_twist: Twist2 = Twist2()
    true_pose: Pose2 | None = None
    measured: tuple[Measurement, ...] = ()
    held_by: HeldBy = HeldBy.NOTHING
    drawing: Drawing = Drawing()
    moving: tuple[MovingObstacle, ...] = ()
    budgets: tuple[Budget, ...] = ()
    charge: float | None = None
    doing: Doing = Doing.AT_WORK
    claims: tuple[tuple[float, float], ...] = ()
    mates: tuple[MateFrame, ...] = ()

    @property
    def seen_from(self) -> Pose2:
        """The robot's pose, ``map`` frame, from which the newest scan is to be drawn."""
        return self.estimate.T_map_base if self.scan_pose is None else self.scan_pose


@dataclass(frozen=True, slots=True, eq=False)
class TickSnapshot:
    """All robots after tick ``index`` at mission time ``stamp_s``."""

    index: int
    stamp_s: float
    robots: tuple[RobotSnapshot, ...]


@dataclass(frozen=True, slots=True)
class Event:
    """Something worth a line: ``level`` is ``debug``, ``info``, ``warning`` or ``error``.

    Sources: ``recovery``, ``safety gate``, ``slam``, ``team``, ``tight place``, ``mission``, a plugin
    (``planner skeleton``) or, at level ``debug``, the path of the leaf that speaks.
    """

    stamp_s: float
    robot: str
    level: str
    source: str
    message: str
