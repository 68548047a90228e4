"""Plans that try passages a little too narrow in the map where no other way, or only a long one, is left."""

from __future__ import annotations

import contextlib
from collections.abc import Callable

from explore_bt.errors import NoPath, PlanningFailure, StartBlocked
from explore_bt.types import Path

__all__ = ["SQUEEZES_M", "plan_or_squeeze"]

SQUEEZES_M = (0.03, 0.05)
"""How much too narrow a passage may be drawn and still be tried."""
_DETOUR_M = 10.0


def plan_or_squeeze(plan: Callable[[float], Path], radius_m: float, straight_m: float) -> Path:
    """A path for the footprint, or one for a slightly smaller one.

    The map counts an obstacle as filling its cell, and draws walls a cell too thick at times. Where that
    closes the only way, or leaves one that a squeeze halves and shortens by 10 m, the safety gate, which is
    finer, decides on the spot.

    Args:
        plan: the path for a footprint's radius in metres, or a ``PlanningFailure``.
        radius_m: the footprint's.
        straight_m: to the goal as the crow flies; paths under twice that and 10 m are taken as they are.

    Raises:
        PlanningFailure: what the planner said to the true footprint.
    """
    try:
        path = plan(radius_m)
    except (NoPath, StartBlocked) as refusal:
        for squeeze_m in SQUEEZES_M:
            with contextlib.suppress(PlanningFailure):
                return plan(radius_m - squeeze_m)
        raise refusal
    if path.length_m > 2.0 * straight_m + _DETOUR_M:
        with contextlib.suppress(PlanningFailure):
            squeezed = plan(radius_m - SQUEEZES_M[0])
            if squeezed.length_m < min(0.5 * path.length_m, path.length_m - _DETOUR_M):
                return squeezed
    return path
