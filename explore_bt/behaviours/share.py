"""What the leaves that look for work have to do with the robot's team."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from explore_bt.interfaces import Offers, RobotServices
from explore_bt.types import Doing, Mate

__all__ = ["allotted", "claimed_before", "claims_of_others", "free_at", "workers"]

_SAME_M = 1.0
_SAME_VIEW_M = 0.1
"""What two places show that are so near is the same: to give one up leads to another view, not back to it."""


def workers(robot: RobotServices) -> list[Mate]:
    """The team mates among whom work is divided."""
    return [mate for mate in robot.team.mates if mate.doing not in (Doing.OVER, Doing.PAUSED)]


def claims_of_others(robot: RobotServices, present: NDArray[np.float64]) -> NDArray[np.float64]:
    """(K, 2) metres: the places that others go to, as far as the robot is to leave them alone.

    Of two that are on their way to the same place, the one whose name comes first goes on.

    Args:
        robot: who asks.
        present: (M, 2) metres, where the robot itself is on its way to.
    """
    if not robot.team.allocator.heeds_claims:
        return np.empty((0, 2))
    found = []
    for mate in workers(robot):
        for place in mate.claims:
            is_own = any(math.dist(place, own) < _SAME_M for own in present.tolist())
            if not (is_own and robot.name < mate.name):
                found.append(place)
    return np.array(found).reshape(-1, 2)


def claimed_before(robot: RobotServices, place: tuple[float, float]) -> str:
    """Who is on its way to the same place and goes on, its name coming first; empty for nobody.

    Both claim it where neither had heard of the other's claim yet.
    """
    if not robot.team.allocator.heeds_claims:
        return ""
    for mate in workers(robot):
        if mate.name < robot.team.name and any(math.dist(place, each) < _SAME_VIEW_M for each in mate.claims):
            return mate.name
    return ""


def free_at(mate: Mate) -> tuple[float, float]:
    """Where a mate will look for more work: at the end of what it has claimed."""
    return mate.claims[-1] if mate.claims else mate.T_map_base.xy


def committed_m(mate: Mate) -> float:
    """About how far it has to go until then, metres."""
    way = (mate.T_map_base.xy, *mate.claims)
    return 1.2 * sum(math.dist(one, other) for one, other in itertools.pairwise(way))


def allotted(
    robot: RobotServices,
    mates: Sequence[Mate],
    gains_m2: Sequence[float],
    between_m: NDArray[np.float64],
    from_others_m: NDArray[np.float64],
    kept: NDArray[np.bool_],
) -> Sequence[int]:
    """Which of N places are the robot's, by its allocator; all of them without mates.

    Args:
        robot: who asks.
        mates: R others.
        gains_m2: (N,) what each place shows.
        between_m: (N + 1, N + 1) metres between the robot (first) and the places.
        from_others_m: (R, N) metres from ``free_at`` of each of them.
        kept: (N,) whether the robot is on its way there.
    """
    if not mates:
        return range(len(gains_m2))
    offers = Offers(
        (robot.name, *(mate.name for mate in mates)),
        np.asarray(gains_m2, dtype=np.float64),
        between_m[1:, 1:],
        np.vstack((between_m[0, 1:], from_others_m)),
        np.array([0.0, *(committed_m(mate) for mate in mates)]),
        kept,
    )
    return robot.team.allocator.allot(offers)
