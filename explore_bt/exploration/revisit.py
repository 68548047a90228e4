"""Revisit suppression: no second time to the same place with the same heading."""

from __future__ import annotations

import math
from collections.abc import Iterable

from explore_bt.types import Pose2

__all__ = ["is_allowed", "repeated_visit"]

_TOUCH_M = 1e-6  # with d̃ = l the last waypoint lies at l exactly, and rounding must not call that nearer


def repeated_visit(
    candidate: Pose2, visited: Iterable[Pose2], detection_range_m: float, revisit_cosine: float
) -> Pose2 | None:
    """The nearest visited waypoint that forbids the candidate, or None where it is allowed.

    A waypoint forbids the candidate if it lies nearer than l and cos(θ − θ_visited) > a^r. The product is
    signed: the opposite heading through the same place is allowed (the paper's Point 1).

    Args:
        candidate: (p^{k+1}, θ), ``map`` frame.
        visited: P, every waypoint so far, ``map`` frame.
        detection_range_m: l.
        revisit_cosine: a^r; 1 switches the rule off, as a reversal does for one decision.
    """
    if revisit_cosine >= 1.0:
        return None
    repeated = (
        pose
        for pose in visited
        if candidate.distance_to(pose) < detection_range_m - _TOUCH_M
        and math.cos(candidate.yaw_rad - pose.yaw_rad) > revisit_cosine
    )
    return min(repeated, key=candidate.distance_to, default=None)


def is_allowed(
    candidate: Pose2, visited: Iterable[Pose2], detection_range_m: float, revisit_cosine: float
) -> bool:
    """Whether the pseudo-code's two tests in FindNextHeading let the candidate pass.

    Every visited waypoint is at least l away, or is nearer and was left in a direction that differs:
    cos(θ − θ_visited) ≤ a^r. Arguments as for :func:`repeated_visit`.
    """
    return repeated_visit(candidate, visited, detection_range_m, revisit_cosine) is None
