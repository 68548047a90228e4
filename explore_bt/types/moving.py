"""A thing that moves by itself: a person, a pet, another robot."""

from __future__ import annotations

import math
from dataclasses import dataclass

from explore_bt.types.pose import Pose2

__all__ = ["MovingObstacle"]


@dataclass(frozen=True, slots=True)
class MovingObstacle:
    """What scans tell about one moving thing; ``map`` frame.

    Attributes:
        number: the same as long as it is held for the same thing.
        xy: centre of what the lidar sees of it, metres.
        velocity_mps: along x and y; zero while it pauses.
        radius_m: all that was seen of it lies within this distance of the centre.
        stamp_s: when it was seen last; it may have moved on since.
        velocity_off_mps: by so much its velocity may be wrong.
    """

    number: int
    xy: tuple[float, float]
    velocity_mps: tuple[float, float]
    radius_m: float
    stamp_s: float
    velocity_off_mps: float = math.inf

    def at(self, time_s: float) -> tuple[float, float]:
        """Where it is at that time if it goes on as it does, metres."""
        ahead_s = time_s - self.stamp_s
        return (self.xy[0] + ahead_s * self.velocity_mps[0], self.xy[1] + ahead_s * self.velocity_mps[1])

    def least_distance_m(self, pose: Pose2, time_s: float, speed_mps: float) -> float:
        """Metres from a pose's centre to the nearest place it may have come to, whichever way it went.

        Args:
            pose: ``map`` frame.
            time_s: when the pose is taken.
            speed_mps: how fast it may be.
        """
        away_m = ((pose.x - self.xy[0]) ** 2 + (pose.y - self.xy[1]) ** 2) ** 0.5
        return away_m - self.radius_m - speed_mps * max(time_s - self.stamp_s, 0.0)
