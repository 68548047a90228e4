"""How a mission ended, in words and numbers."""

from __future__ import annotations

import enum
from dataclasses import asdict, dataclass, field

__all__ = ["MappingResult", "Outcome", "Result", "Score"]


class Outcome(enum.StrEnum):
    """Why a mission ended; ``MAPPED``: a recorded log has come to its end, ``CUT``: the process died."""

    EXPLORED = "explored"
    MAPPED = "mapped"
    STOPPED = "stopped"
    BUDGET = "budget"
    FAILED = "failed"
    CUT = "cut"


@dataclass(frozen=True, slots=True)
class Score:
    """Running figures of one robot; ``None`` where only the truth could tell and nobody knows it.

    Attributes:
        distance_m: driven so far, by the estimate.
        coverage: share [0, 1] of the reachable observable floor that is mapped free.
        contacts: separate touches of an obstacle, or of somebody while the robot moved.
        touched_by_people: separate touches by somebody while it stood.
        clearance_m: from the robot's **centre** to the nearest obstacle, now.
        min_clearance_m, mean_clearance_m: the same over the run (mean over distance driven).
        ate_rmse_m: root mean square of the position error after the best rigid alignment.
    """

    distance_m: float = 0.0
    coverage: float | None = None
    contacts: int | None = None
    touched_by_people: int | None = field(default=None, kw_only=True)
    clearance_m: float | None = None
    min_clearance_m: float | None = None
    mean_clearance_m: float | None = None
    ate_rmse_m: float | None = None
    distance_to_home_m: float = 0.0


@dataclass(frozen=True, slots=True)
class Result:
    """The content of ``result.json``.

    Attributes:
        outcome, reason: why the mission ended.
        left_open: what was not explored and why, one sentence each.
        slam: the SLAM plugin's own figures (``loop_closures``, ``keyframes``, ...).
        mocked: paths of the leaves that a script played; none in a run that counts.
        not_merged: whose maps are not part of the map of all and why, one sentence each.
    """

    outcome: Outcome
    reason: str
    mission: str
    coverage: float | None
    contacts: int | None
    touched_by_people: int | None = field(default=None, kw_only=True)
    ate_rmse_m: float | None
    path_length_m: float
    mission_time_s: float
    wall_time_s: float
    min_clearance_m: float | None
    mean_clearance_m: float | None
    distance_to_home_m: float
    seed: int
    mission_sha256: str
    version: str
    left_open: tuple[str, ...] = ()
    slam: dict[str, float] = field(default_factory=dict)
    mocked: tuple[str, ...] = ()
    not_merged: tuple[str, ...] = ()

    def as_dict(self) -> dict[str, object]:
        """Plain values, ready for JSON."""
        return asdict(self)


@dataclass(frozen=True, slots=True, kw_only=True)
class MappingResult(Result):
    """The content of ``result.json`` where the measurements came from a log: what only a robot has is None.

    Attributes:
        log: the file.
        relations: error over verified relations (Kümmerle et al. 2009), None without any.
        scans, loop_closures: how many.
        ms_per_scan_median, ms_per_scan_p99: computing time of SLAM, wall clock.
        peak_memory_mb: most memory that the process ever held.
        health: ``{"t", "state", "reason"}`` of every change of SLAM's trust in itself; t in mission time.
        notes: what had to be assumed about the log, one sentence each.
    """

    log: str
    relations: dict[str, float] | None
    scans: int
    loop_closures: int
    ms_per_scan_median: float
    ms_per_scan_p99: float
    peak_memory_mb: float
    health: tuple[dict[str, object], ...]
    notes: tuple[str, ...] = ()
