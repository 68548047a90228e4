"""Contract of controllers: a path in, twists out."""

from __future__ import annotations

import enum
from abc import abstractmethod
from dataclasses import dataclass

from explore_bt.interfaces.plugin import Plugin, RobotContext
from explore_bt.interfaces.surroundings import Surroundings
from explore_bt.types import Estimate, MotionState, Path, Scan2D, Twist2

__all__ = ["ControlOutput", "ControlStatus", "Controller"]


class ControlStatus(enum.StrEnum):
    """How the present path is going."""

    IDLE = "idle"
    RUNNING = "running"
    ARRIVED = "arrived"
    STUCK = "stuck"


@dataclass(frozen=True, slots=True)
class ControlOutput:
    """One control step: the twist wanted for the next period, and how things stand."""

    twist: Twist2
    status: ControlStatus
    reason: str = ""


class Controller(Plugin):
    """Follows a path with a unicycle, within limits of velocity, acceleration and jerk.

    All methods are called by the control thread; ``step`` takes well under a control period.
    """

    kind = "controller"

    @abstractmethod
    def setup(self, context: RobotContext) -> None:
        """Learn the limits (``context.limits``); compile and warm up."""

    @abstractmethod
    def follow(self, path: Path) -> None:
        """Follow this path from now on; a path of one pose is a turn in place.

        May come while another path is being followed: the motion goes over without a halt if it can.
        """

    @abstractmethod
    def hold(self) -> None:
        """Come to rest under the limits and stay; status becomes ``idle`` once at rest."""

    def see(self, surroundings: Surroundings) -> None:
        """What is around the robot, told after every scan; for controllers that steer clear of it.

        Whatever a controller makes of it, the safety gate checks every command.
        """

    @abstractmethod
    def step(
        self, estimate: Estimate, scan: Scan2D | None, motion: MotionState, dt_s: float
    ) -> ControlOutput:
        """The twist for the next ``dt_s`` seconds.

        Args:
            estimate: the newest pose.
            scan: the newest scan, None before the first.
            motion: the command that was really sent last, after the safety gate: start from there.
            dt_s: the control period; the change of twist and of acceleration over it stays within
                the limits.
        """
