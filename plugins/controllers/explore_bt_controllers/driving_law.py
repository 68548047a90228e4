"""How a leg is driven: the part in which controllers differ."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from explore_bt.types import MotionLimits, MotionState, Pose2
from explore_bt_controllers.track import Leg
from explore_bt_controllers.wish import Wish

__all__ = ["DrivingLaw", "Place"]


@dataclass(frozen=True, slots=True)
class Place:
    """Where the robot is on a leg.

    Attributes:
        leg: being driven.
        pose: of the robot, ``map`` frame.
        time_s: of the pose.
        along_m: arc length.
        lateral_m: offset from the leg, left is positive.
        heading_error_rad: the robot's heading minus the leg's.
    """

    leg: Leg
    pose: Pose2
    time_s: float
    along_m: float
    lateral_m: float
    heading_error_rad: float


class DrivingLaw(Protocol):
    """Asked once per period while a leg is driven; turns and arrival are the follower's."""

    def drive(self, place: Place, motion: MotionState, limits: MotionLimits, dt_s: float) -> Wish:
        """What to command for the next ``dt_s`` seconds; ``motion`` is what was sent last."""

    def hindrance(self) -> str:
        """What keeps the robot from going on, in words; empty if it knows of nothing."""
