"""What leaves look at, as marks for the observers' maps."""

from __future__ import annotations

import math
from collections.abc import Iterable

from explore_bt.exploration import FreeSector, HalfPlane
from explore_bt.types import HalfPlaneMark, Pose2, SectorMark, Verdict

__all__ = ["half_plane_marks", "sector_mark"]


def sector_mark(
    pose: Pose2, sector: FreeSector, range_m: float, state: Verdict = Verdict.OPEN, reason: str = ""
) -> SectorMark:
    """A free sector seen from a pose (``map`` frame), clear up to a distance."""
    first, last = pose.yaw_rad + sector.start_rad, pose.yaw_rad + sector.end_rad
    return SectorMark(pose.x, pose.y, first, last, range_m, state, reason)


def half_plane_marks(planes: Iterable[HalfPlane]) -> tuple[HalfPlaneMark, ...]:
    """The newest first; ``planes`` come oldest first."""
    return tuple(
        HalfPlaneMark(*plane.position, math.cos(plane.heading_rad), math.sin(plane.heading_rad))
        for plane in reversed(tuple(planes))
    )
