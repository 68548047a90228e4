"""What a report remembers of one robot's run."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, fields

import numpy as np
from numpy.typing import NDArray

from explore_bt.exploration.clearance import clearance_field
from explore_bt.interfaces import HeldBy, NodeInfo, RobotSnapshot
from explore_bt.recording import TreeTally
from explore_bt.report.first_seen import FirstSeen
from explore_bt.types import OccupancyGrid, Waypoint

__all__ = ["Intervention", "RobotHistory", "TimedWaypoint", "Track", "clearance_range_m"]

_MAP_PERIOD_S = 1.0
_CALM_S = 1.0


@dataclass(slots=True)
class Intervention:
    """A stretch of time in which the safety gate braked; breaks of less than a second belong to it."""

    begin_s: float
    end_s: float
    reason: str
    held_by: HeldBy


@dataclass(frozen=True, slots=True)
class TimedWaypoint:
    """A waypoint, and when it was reached."""

    stamp_s: float
    waypoint: Waypoint


@dataclass(frozen=True, slots=True, eq=False)
class Track:
    """One sample per tick.

    Attributes:
        stamps_s: (N,) float64 mission time.
        poses: (N, 3) float64 x, y (m), yaw (rad), ``map`` frame, finite.
        clearance_m: (N,) float64 from the robot's centre; NaN where nobody knows.
        distance_m, speed_mps: (N,) float64.
        coverage, charge: (N,) float64 shares, of the floor and of the battery; NaN where nobody knows.
    """

    stamps_s: NDArray[np.float64]
    poses: NDArray[np.float64]
    clearance_m: NDArray[np.float64]
    distance_m: NDArray[np.float64]
    speed_mps: NDArray[np.float64]
    coverage: NDArray[np.float64]
    charge: NDArray[np.float64]

    def thinned(self, most: int) -> Track:
        """At most ``most`` samples, first and last among them."""
        count = len(self.stamps_s)
        if count <= most:
            return self
        kept = np.unique(np.linspace(0, count - 1, most).round().astype(np.int64))
        columns = (getattr(self, each.name)[kept] for each in fields(self))
        return Track(*columns)


@dataclass(slots=True)
class RobotHistory:
    """Grows with every tick.

    Attributes:
        nodes: the robot's tree.
        most_moving: how many people and other things that move were seen at once.
        tally: for each node of the tree, what it did.
    """

    name: str
    footprint_radius_m: float
    nodes: tuple[NodeInfo, ...]
    grid: OccupancyGrid | None = None
    interventions: list[Intervention] = field(default_factory=list)
    waypoints: list[TimedWaypoint] = field(default_factory=list)
    most_moving: int = 0
    tally: TreeTally = field(default_factory=TreeTally)
    first_seen: FirstSeen = field(default_factory=FirstSeen)
    _rows: list[tuple[float, ...]] = field(default_factory=list)
    _visited: tuple[object, ...] = ()
    _map_due_s: float = -math.inf

    def on_tick(self, stamp_s: float, robot: RobotSnapshot) -> None:
        """Take in one tick."""
        self._sample(stamp_s, robot)
        self._map(stamp_s, robot.grid)
        self._gate(stamp_s, robot)
        self._waypoints(stamp_s, robot.blackboard.get("visited"))
        self.tally.on_tick(stamp_s, robot.nodes)

    def finish(self) -> None:
        """Take in the last map, which may have come between two looks."""
        if self.grid is not None and self._rows:
            self.first_seen.note(self._rows[-1][0], self.grid)

    def track(self) -> Track:
        """The drive so far; clearance is taken from the map where the driver doesn't know it."""
        table = np.array(self._rows, dtype=np.float64).reshape(-1, 9)
        table = table[np.isfinite(table[:, :4]).all(axis=1)]
        clearance = table[:, 4]
        if self.grid is not None and len(table) and np.isnan(clearance).all():
            clearance = _clearance_on(self.grid, table[:, 1:3])
        return Track(table[:, 0], table[:, 1:4], clearance, *table[:, 5:].T)

    def _sample(self, stamp_s: float, robot: RobotSnapshot) -> None:
        pose, score = robot.estimate.T_map_base, robot.score
        clearance = math.nan if score.clearance_m is None else score.clearance_m
        coverage = math.nan if score.coverage is None else score.coverage
        speed = robot.motion.twist.linear_mps
        charge = math.nan if robot.charge is None else robot.charge
        self._rows.append(
            (stamp_s, pose.x, pose.y, pose.yaw_rad, clearance, score.distance_m, speed, coverage, charge)
        )

    def _map(self, stamp_s: float, grid: OccupancyGrid) -> None:
        if grid is not self.grid and stamp_s >= self._map_due_s:
            self._map_due_s = stamp_s + _MAP_PERIOD_S
            self.first_seen.note(stamp_s, grid)
        self.grid = grid

    def _gate(self, stamp_s: float, robot: RobotSnapshot) -> None:
        if robot.gate_reason:
            last = self.interventions[-1] if self.interventions else None
            if last is None or stamp_s - last.end_s > _CALM_S or last.held_by is not robot.held_by:
                last = Intervention(stamp_s, stamp_s, robot.gate_reason, robot.held_by)
                self.interventions.append(last)
            last.end_s = stamp_s
        self.most_moving = max(self.most_moving, len(robot.moving))

    def _waypoints(self, stamp_s: float, visited: object) -> None:
        if visited is self._visited or not isinstance(visited, tuple):
            return
        known = len(self._visited)
        if visited[:known] != self._visited:  # the list was begun anew
            self.waypoints, known = [], 0
        new = (waypoint for waypoint in visited[known:] if isinstance(waypoint, Waypoint))
        self.waypoints += [TimedWaypoint(stamp_s, waypoint) for waypoint in new]
        self._visited = visited


def _clearance_on(grid: OccupancyGrid, points: NDArray[np.float64]) -> NDArray[np.float64]:
    cells = grid.cells_of(points)
    rows, cols = cells[:, 0], cells[:, 1]
    inside = (rows >= 0) & (rows < grid.shape[0]) & (cols >= 0) & (cols < grid.shape[1])
    clearance = np.full(len(points), np.nan)
    clearance[inside] = clearance_field(grid)[rows[inside], cols[inside]]
    return clearance


def clearance_range_m(tracks: Sequence[Track], radius_m: float) -> tuple[float, float]:
    """From the footprint's radius to what counts as wide: the ends of the colour scale, metres."""
    known = np.concatenate([track.clearance_m for track in tracks]) if tracks else np.empty(0)
    known = known[np.isfinite(known)]
    widest = float(np.percentile(known, 95)) if len(known) else 0.0
    return (radius_m, max(widest, radius_m + 0.3))
