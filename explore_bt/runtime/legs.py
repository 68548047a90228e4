"""A path over places on the way, leg by leg."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from itertools import pairwise

import numpy as np

from explore_bt.errors import Cancelled, PlanningFailure
from explore_bt.types import Path, Pose2

__all__ = ["plan_through"]

_HERE_M = 0.1


def plan_through(
    plan: Callable[[Pose2, Pose2], Path], here: Pose2, via: Sequence[tuple[float, float]], goal: Pose2
) -> Path:
    """Plan each leg and join them; without ``via`` this is ``plan(here, goal)``.

    A place that no way leads to, or from which none leads on, is left out: only the goal has to be reached.

    Args:
        plan: a path from one pose to another, or a ``PlanningFailure``.
        here: where the first leg begins.
        via: (x, y) metres, places to pass, in this order.
        goal: where the last leg ends.

    Raises:
        PlanningFailure: what was said to the way straight to the goal.
    """
    legs: list[Path] = []
    start = here
    for place, after in pairwise((*via, goal.xy)):
        if math.dist(place, start.xy) <= _HERE_M or math.dist(place, goal.xy) <= _HERE_M:
            continue
        heading_rad = math.atan2(after[1] - place[1], after[0] - place[0])
        try:
            legs.append(plan(start, Pose2(*place, heading_rad)))
        except Cancelled:
            raise
        except PlanningFailure:
            continue
        start = legs[-1].goal
    if not legs:
        return plan(here, goal)
    try:
        return _joined([*legs, plan(start, goal)])
    except Cancelled:
        raise
    except PlanningFailure:
        return plan(here, goal)


def _joined(legs: Sequence[Path]) -> Path:
    """One path of several, each of which begins where the one before ends."""
    first, *others = legs
    return Path(
        np.vstack((first.poses, *(leg.poses[1:] for leg in others))),
        np.concatenate((first.clearance_m, *(leg.clearance_m[1:] for leg in others))),
    )
