"""What leaves ask about team mates that they meet."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from explore_bt.interfaces import HeldBy, RobotServices
from explore_bt.types import Mate

__all__ = ["course_of", "goes_before", "mate_in_the_way", "needed_apart_m"]

_SPARE_M = 0.15


def goes_before(robot: RobotServices, mate: Mate) -> bool:
    """Whether the mate has the way where both want it: all robots answer alike."""
    return mate.right_of_way < robot.team.right_of_way


def mate_in_the_way(robot: RobotServices) -> Mate | None:
    """The team mate that the robot is being held for."""
    if robot.pilot.held_by is not HeldBy.MATE:
        return None
    return next((mate for mate in robot.team.mates if mate.name == robot.pilot.in_the_way), None)


def course_of(mate: Mate) -> NDArray[np.float64]:
    """(M, 2) metres: where it is, and where its path leads in the next metres."""
    return np.vstack((mate.T_map_base.xy, mate.ahead))


def needed_apart_m(robot: RobotServices, mate: Mate) -> float:
    """What has to be between the centres of the two for one to pass the other."""
    return robot.footprint_radius_m + mate.radius_m + _SPARE_M
