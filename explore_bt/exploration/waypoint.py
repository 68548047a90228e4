"""The next waypoint along a sector's bisector."""

from __future__ import annotations

import math

from explore_bt.exploration.arguments import require_positive
from explore_bt.exploration.free_sectors import FreeSector
from explore_bt.types import Pose2, Waypoint, wrap_angle

__all__ = ["next_waypoint"]


def next_waypoint(pose: Pose2, sector: FreeSector, step_length_m: float) -> Waypoint:
    """Equations 1–3 of the paper's waypoint section.

    p^{k+1} = p^k + d̃ (cos θ, sin θ) and r^{k+1,z} = θ, with θ = q^− + q/2 turned into the ``map`` frame.

    Args:
        pose: the robot at p^k, ``map`` frame.
        sector: q_i, in the robot's frame.
        step_length_m: d̃. The paper keeps it constant and ≥ l; below l the revisit rule would forbid
            going straight on.

    Raises:
        ArgumentError: if the step is not above zero.
    """
    require_positive(step_length_m=step_length_m)
    heading_rad = pose.yaw_rad + sector.bisector_rad
    if not -math.pi <= heading_rad < math.pi:  # wrapping rounds, and a straight course must not wear off
        heading_rad = wrap_angle(heading_rad)
    return Waypoint(
        Pose2(
            pose.x + step_length_m * math.cos(heading_rad),
            pose.y + step_length_m * math.sin(heading_rad),
            heading_rad,
        )
    )
