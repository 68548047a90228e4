"""Options of the controllers."""

from __future__ import annotations

import math

from pydantic import Field

from explore_bt.interfaces import PluginOptions
from explore_bt.units import Acceleration, Angle, Duration, Length

__all__ = ["FollowerOptions", "PursuitOptions"]


class FollowerOptions(PluginOptions):
    """Options of every controller that follows a path."""

    position_tolerance: Length = Field(
        0.08, gt=0.02, description="how near the end of the path counts as arrived"
    )
    heading_tolerance: Angle = Field(
        0.15, gt=0.0, description="how far the final heading may be off before the robot turns to it"
    )
    turn_from: Angle = Field(
        math.radians(50.0), gt=0.1, lt=math.pi, description="bends sharper than this are turned in place"
    )
    convergence: Length = Field(
        0.3, gt=0.05, description="arc length over which an offset from the path is taken back"
    )
    slow_below: Length = Field(
        0.1, ge=0.0, description="room beside the footprint under which speed falls in proportion, to a fifth"
    )
    lateral_acceleration: Acceleration = Field(0.5, gt=0.0, description="greatest centripetal acceleration")
    off_path: Length = Field(0.5, gt=0.0, description="distance from the path at which it is given up")
    stuck_after: Duration = Field(5.0, gt=0.0, description="time without progress after which it is given up")


class PursuitOptions(FollowerOptions):
    """Options of the controller ``pursuit``."""
