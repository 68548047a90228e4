"""Options of the controllers."""

from __future__ import annotations

import math

from pydantic import Field

from explore_bt.interfaces import PluginOptions
from explore_bt.units import Acceleration, Angle, AngularRate, Duration, Length, Speed

__all__ = ["FollowerOptions", "MppiOptions", "PursuitOptions"]


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


class MppiOptions(FollowerOptions):
    """Options of the controller ``mppi``."""

    off_path: Length = Field(1.6, gt=0.0, description="distance from the path at which it is given up")
    samples: int = Field(1000, ge=50, le=20_000, description="motions tried in each period")
    steps: int = Field(40, ge=5, le=200, description="steps of each motion")
    step_time: Duration = Field(0.08, gt=0.01, le=0.5, description="length of a step")
    temperature: float = Field(
        0.03, gt=0.0, description="difference of cost at which a motion counts e times less than the best"
    )
    speed_noise: Speed = Field(0.1, gt=0.0, description="standard deviation of the sampled velocities")
    turn_noise: AngularRate = Field(0.4, gt=0.0, description="standard deviation of the sampled turn rates")
    noise_time: Duration = Field(0.3, gt=0.0, description="time over which sampled velocities hang together")
    reverse_speed: Speed = Field(0.0, ge=0.0, description="greatest velocity backwards")
    deviation: Length = Field(1.0, gt=0.0, description="how far from the path it drives around obstacles")
    margin: Length = Field(0.03, ge=0.0, description="least room beside the footprint")
    soft_margin: Length = Field(
        0.25, gt=0.0, description="room beside the footprint under which speed has its price"
    )
    moving_margin: Length = Field(0.02, ge=0.0, description="least distance from what moves")
    moving_soft_margin: Length = Field(
        0.1, gt=0.0, description="distance from what moves that it likes to keep"
    )
    moving_doubt: Speed = Field(
        0.0, ge=0.0, description="growth of that distance per second of looking ahead"
    )
