"""What a robot offers to the leaves of its tree."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from explore_bt.exploration.clearance import Clearances
from explore_bt.exploration.ground import Ground, GroundMemory
from explore_bt.interfaces.controller import ControlOutput
from explore_bt.interfaces.held_by import HeldBy
from explore_bt.interfaces.team_services import TeamServices
from explore_bt.types import (
    BodyFault,
    Budget,
    Drawing,
    Estimate,
    MovingObstacle,
    OccupancyGrid,
    Path,
    Pose2,
    Scan2D,
    Trajectory,
)

__all__ = ["MapMemory", "MapView", "Pilot", "RobotServices"]


class MapMemory:
    """What makes deriving things from the next state of a map cheap."""

    def __init__(self) -> None:
        self.clearances, self.ground = Clearances(), GroundMemory()


class MapView:
    """One revision of the map with what is often derived from it, computed at most once."""

    def __init__(self, grid: OccupancyGrid, memory: MapMemory | None = None) -> None:
        """View a map; with the memory of its earlier states what is derived costs less."""
        self.grid = grid
        self._memory = memory or MapMemory()

    @cached_property
    def clearance_m(self) -> NDArray[np.float32]:
        """(rows, cols) float32, metres to the nearest obstacle **or unknown** cell."""
        return self._memory.clearances.of(self.grid)

    @cached_property
    def ground(self) -> Ground:
        """The map in blocks of 10 cm, as decisions see it."""
        return Ground(self.grid, self._memory.ground)


class Pilot(Protocol):
    """The way from a decision to the wheels: controller, then safety gate, then driver."""

    def follow(self, path: Path) -> None:
        """Drive along a path from the next control step on."""

    def hold(self) -> None:
        """Come to rest under the limits."""

    @property
    def output(self) -> ControlOutput:
        """The controller's last word on the present path."""

    @property
    def blocked_s(self) -> float:
        """For how long the robot has been braked for without a break, seconds; 0 while commands pass."""

    @property
    def gate_reason(self) -> str:
        """Why the robot is being braked for; empty while commands pass."""

    @property
    def held_by(self) -> HeldBy:
        """What the robot is being braked for."""

    @property
    def body_fault(self) -> BodyFault | None:
        """Why the body cannot drive now; None while it can."""

    def recover_body(self) -> bool:
        """Have the body begin to get out of its fault; False where it cannot."""

    @property
    def in_the_way(self) -> str:
        """The name of the team mate that the robot was last held for; empty before."""


class RobotServices(Protocol):
    """Given to every leaf at construction; valid to use from ``initialise`` on."""

    @property
    def name(self) -> str:
        """The robot's name in the mission."""

    @property
    def footprint_radius_m(self) -> float:
        """Radius of the circular footprint."""

    @property
    def least_margin_m(self) -> float:
        """What plans keep beyond the footprint; below 0 where something finer than the map decides."""

    @property
    def lidar_range_m(self) -> float:
        """How far the lidar sees."""

    @property
    def home(self) -> Pose2:
        """Where the mission began, ``map`` frame."""

    @property
    def pilot(self) -> Pilot:
        """The way to the wheels."""

    @property
    def team(self) -> TeamServices:
        """Its place among the robots of the mission."""

    @property
    def stop_requested(self) -> bool:
        """The paper's ``stop_exploration``."""

    @property
    def moving(self) -> tuple[MovingObstacle, ...]:
        """What moves around the robot, as the newest scan tells."""

    @property
    def distance_m(self) -> float:
        """Driven since the start, metres."""

    def now_s(self) -> float:
        """Mission time, seconds; it stands still while a debugger holds the tree, stamps do not."""

    def budgets(self) -> tuple[Budget, ...]:
        """What of time, distance and battery the mission allows still; none where it sets no limit."""

    def estimate(self) -> Estimate:
        """The newest pose."""

    def trajectory(self) -> Trajectory:
        """The way driven so far, ``map`` frame, as SLAM believes it now."""

    def view(self) -> MapView:
        """The newest map; where the robot has seen nothing itself, what its team has seen."""

    def scan(self) -> Scan2D | None:
        """The newest scan, None before the first."""

    def plan(self, goal: Pose2, via: Sequence[tuple[float, float]] = ()) -> Path:
        """A path from here, by the mission's planner; raises a ``PlanningFailure``.

        It passes the places of ``via`` in their order, but those that no way leads over.
        """

    def draw(self, drawing: Drawing) -> None:
        """Show observers what a leaf looked at when it decided; layers of one tick lie over one another."""

    def avoid(self, position: tuple[float, float]) -> None:
        """Close a place (x, y, metres, ``map`` frame) that proved too tight: plans and maps shun it."""

    def clear_map(self, radius_m: float) -> bool:
        """Have SLAM forget the obstacles within so many metres until it sees them again; whether it can."""

    def reopen(self, chances: int) -> int:
        """Open such places again, unless that was done ``chances`` times before; how many."""
