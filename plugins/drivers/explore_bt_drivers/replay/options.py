"""Options of the replay."""

from __future__ import annotations

import math

from pydantic import Field

from explore_bt.interfaces import PluginOptions
from explore_bt.types import MotionLimits
from explore_bt.units import Angle, AngularRate, FileOrFolderPath, Length, Speed

__all__ = ["ReplayOptions"]


class ReplayOptions(PluginOptions):
    """Which log, and what the log itself does not say."""

    log: FileOrFolderPath = Field(
        description="CARMEN log (also .gz, .bz2), recording.mcap, ROS 1 bag, ROS 2 bag folder"
    )
    radius: Length | None = Field(
        None, ge=0.05, le=2.0, description="of the circular footprint; none: as recorded, else 25 cm"
    )
    speed: Speed = Field(2.0, ge=0.01, le=20.0, description="the recorded robot was never faster")
    turn_rate: AngularRate = Field(3.0, ge=0.01, le=20.0, description="it never turned faster")
    range_max: Length | None = Field(
        None, gt=0.0, description="returns from there on mean nothing was hit; none: as the log says or shows"
    )
    field_of_view: Angle = Field(math.pi, gt=0.0, le=2.0 * math.pi, description="of CARMEN's FLASER lines")
    odom_lines: bool = Field(False, description="play CARMEN's ODOM lines too; laser lines carry odometry")
    robot: str | None = Field(None, description="whose scans of a recording.mcap; none: the first robot's")
    scan_topic: str | None = Field(None, description="the lidar's topic in a bag; none: the only one")

    colour_topic: str | None = Field(None, description="a bag's camera; none: the only one with depth")
    depth_topic: str | None = Field(None, description="its depth, registered; none: the only one that fits")

    @property
    def limits(self) -> MotionLimits:
        """What is known of the recorded body; the rest is nobody's limit."""
        return MotionLimits(speed_mps=self.speed, turn_rate_rps=self.turn_rate)
