"""What leaves ask about the people around the robot."""

from __future__ import annotations

from explore_bt.interfaces import HeldBy, RobotServices
from explore_bt.types import MovingObstacle, Pose2

__all__ = ["SOMEONE", "someone_is_in_the_way", "who_is_near"]

SOMEONE = "someone_in_the_way"
"""Code of the failure of a drive that someone was in the way of."""
_CLOSE_M = 1.0
"""Someone so near is why a scan holds the robot, not the furniture."""


def who_is_near(robot: RobotServices, place: Pose2, within_m: float) -> list[MovingObstacle]:
    """Who was seen nearer to a place (``map`` frame) than so many metres."""
    now_s = robot.now_s()
    return [thing for thing in robot.moving if thing.least_distance_m(place, now_s, 0.0) < within_m]


def someone_is_in_the_way(robot: RobotServices) -> bool:
    """Whether the robot does not get on because someone is about."""
    if robot.pilot.held_by is HeldBy.SOMEONE:
        return True
    return bool(who_is_near(robot, robot.estimate().T_map_base, robot.footprint_radius_m + _CLOSE_M))
