"""One exploration with perfect poses: how far a strategy drives for what it sees.

The loop of every foreign simulator, and the fastest one: a grid and a pose go in, a path comes out and is
driven exactly, from where the robot stands. The explorer is asked every ``decide_every_m``, at the end of
each path, and as soon as the map shows that the next metre of the path is blocked.
"""

from __future__ import annotations

import math
import time
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from explore_bt.evaluation.trial_robot import MapDrawer, TrialRobot, TrialSettings, TrueWorld
from explore_bt.exploration.clearance import clearance_at
from explore_bt.types import OccupancyGrid, Path, Pose2

__all__ = ["Decider", "Decision", "Trial", "run_trial"]

_LOOK_AHEAD_M = 1.0
_SAME_GOAL_M = 0.25
_MOVED_M = 0.02
_TURNED_RAD = 0.05
_IDLE_DECISIONS = 20


class Decision(Protocol):
    """What an explorer answers."""

    @property
    def goal(self) -> Pose2 | None:
        """Where to."""

    @property
    def path(self) -> Path | None:
        """How to get there."""

    @property
    def done(self) -> bool:
        """Whether it has finished."""

    @property
    def reason(self) -> str:
        """Why, in words."""


class Decider(Protocol):
    """An explorer."""

    def decide(self, grid: OccupancyGrid, pose: Pose2) -> Decision:
        """Called whenever the robot wants to know where to go."""


@dataclass(frozen=True, slots=True, eq=False)
class Trial:
    """What came of it.

    Attributes:
        outcome: the explorer's own ``outcome`` if it finished and says one, else ``done``; ``over_budget`` or
            ``stuck`` if it did not finish.
        contacts: how often the footprint would have touched something; the robot stops there each time.
        turning_rad: sum of all changes of heading.
        goal_changes: how often a goal lay elsewhere (by 0.25 m) than the one before.
        goals_dropped: those of them where the goal before had not been reached.
        decision_s: (N,) float64, CPU seconds of every decision.
        curve: (M, 3) float64, one row a scan: metres driven, seconds, coverage.
        track: (M, 3) float64, one row a scan: x, y in metres, yaw in radians.
        grid: the map at the end.
    """

    outcome: str
    reason: str
    coverage: float
    path_m: float
    time_s: float
    turning_rad: float
    mean_clearance_m: float
    min_clearance_m: float
    contacts: int
    goal_changes: int
    goals_dropped: int
    decision_s: NDArray[np.float64]
    curve: NDArray[np.float64]
    track: NDArray[np.float64]
    grid: OccupancyGrid

    def path_to_m(self, coverage: float) -> float:
        """Metres driven when that share was reached; inf if it never was."""
        return self._first(coverage, 0)

    def time_to_s(self, coverage: float) -> float:
        """Seconds when that share was reached; inf if it never was."""
        return self._first(coverage, 1)

    def coverage_at_s(self, time_s: float) -> float:
        """The share reached by then."""
        return float(self.curve[max(int(np.searchsorted(self.curve[:, 1], time_s, "right")) - 1, 0), 2])

    def _first(self, coverage: float, column: int) -> float:
        reached = self.curve[:, 2] >= coverage
        return float(self.curve[int(np.argmax(reached)), column]) if reached.any() else math.inf


def run_trial(
    decider: Decider,
    world: TrueWorld,
    drawer: MapDrawer,
    floor: OccupancyGrid,
    start: Pose2,
    settings: TrialSettings,
) -> Trial:
    """Let an explorer explore.

    Args:
        decider: asked for decisions; what it raises ends the trial.
        world: the truth.
        drawer: an empty map in the world's frame.
        floor: its ``FREE`` cells are to be seen.
        start: where the robot stands first, in the world.
        settings: robot and budget.

    Raises:
        WorldError: the floor has no free cell.
    """
    robot = TrialRobot(world, drawer, floor, start, settings)
    log = _DecisionLog()
    idle = 0
    while True:
        decision = log.ask(decider, robot)
        if decision.done:
            return _trial(robot, log, str(getattr(decision, "outcome", "") or "done"), decision.reason)
        if robot.path_m >= settings.most_path_m:
            return _trial(robot, log, "over_budget", f"{settings.most_path_m:g} m are driven")
        path_m, turning_rad = robot.path_m, robot.turning_rad
        if decision.path is not None:
            _follow(robot, decision.path, settings)
        moved = robot.path_m - path_m > _MOVED_M or robot.turning_rad - turning_rad > _TURNED_RAD
        idle = 0 if moved else idle + 1
        if idle >= _IDLE_DECISIONS:
            return _trial(robot, log, "stuck", f"{idle} decisions moved nothing: {decision.reason}")


class _DecisionLog:
    """Asks, takes the time, and notes how goals change."""

    def __init__(self) -> None:
        self.seconds: list[float] = []
        self.changes = self.dropped = 0
        self._goal: Pose2 | None = None

    def ask(self, decider: Decider, robot: TrialRobot) -> Decision:
        grid, pose = robot.grid, robot.pose
        begun = time.process_time()
        decision = decider.decide(grid, pose)
        self.seconds.append(time.process_time() - begun)
        if self._goal is not None and decision.goal is not None:
            reached = pose.distance_to(self._goal) < _SAME_GOAL_M
            if decision.goal.distance_to(self._goal) > _SAME_GOAL_M:
                self.changes += 1
                self.dropped += not reached
        self._goal = decision.goal or self._goal
        return decision


def _follow(robot: TrialRobot, path: Path, settings: TrialSettings) -> None:
    """Drive until it is time to ask again; a path of one pose is a turn in place."""
    way = [(float(x), float(y)) for x, y in path.poses[:, :2]] if len(path.poses) > 1 else []
    until_m = robot.path_m + settings.decide_every_m
    while way and robot.path_m < until_m - _MOVED_M:
        if not robot.drive(way, min(settings.step_m, until_m - robot.path_m)):
            return
        if way and _is_blocked(robot, way, settings.radius_m):
            return
    if not way:
        robot.turn_to(path.goal.yaw_rad)


def _is_blocked(robot: TrialRobot, way: list[tuple[float, float]], radius_m: float) -> bool:
    """Whether the map leaves the footprint no room on the next metre, by more than a cell."""
    grid = robot.grid
    pieces, here, left_m = [np.array([robot.pose.xy])], np.array(robot.pose.xy), _LOOK_AHEAD_M
    for vertex in way:
        along = np.array(vertex) - here
        length_m = float(np.hypot(*along))
        shares = np.linspace(
            0.0, min(1.0, left_m / max(length_m, 1e-9)), 2 + int(length_m / grid.resolution_m)
        )
        pieces.append(here + shares[:, None] * along)
        here, left_m = here + along, left_m - length_m
        if left_m <= 0.0:
            break
    room_m = clearance_at(grid, np.concatenate(pieces), radius_m)
    return bool((room_m < radius_m - grid.resolution_m).any())


def _trial(robot: TrialRobot, log: _DecisionLog, outcome: str, reason: str) -> Trial:
    return Trial(
        outcome=outcome,
        reason=reason,
        coverage=robot.coverage,
        path_m=robot.path_m,
        time_s=robot.time_s,
        turning_rad=robot.turning_rad,
        mean_clearance_m=robot.mean_clearance_m,
        min_clearance_m=robot.min_clearance_m,
        contacts=robot.contacts,
        goal_changes=log.changes,
        goals_dropped=log.dropped,
        decision_s=np.array(log.seconds),
        curve=robot.curve,
        track=robot.track,
        grid=robot.grid,
    )
