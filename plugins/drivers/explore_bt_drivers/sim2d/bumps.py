"""Robots that run into one another."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence

from explore_bt_drivers.sim2d.body import Body
from explore_bt_drivers.sim2d.motion import STEP_S

__all__ = ["Bumps"]

_TOUCH_M = 1e-6
_LEAVE_M = 0.005
_FAR_STEPS = 2**31


class Bumps:
    """Keeps discs from passing through one another, and counts the touches on both sides.

    A touch lasts from an overlap until the two are 5 mm apart.
    """

    def __init__(self, bodies: Sequence[Body]) -> None:
        """Watch these; more may join."""
        self._bodies = bodies
        self._touching: set[tuple[int, int]] = set()

    def apart_steps(self) -> int:
        """For so many internal steps no two can meet; 1 where they can, then they go step by step."""
        steps = _FAR_STEPS
        for one, other in itertools.combinations(self._bodies, 2):
            closing_m = (one.speed_limit_mps + other.speed_limit_mps) * STEP_S
            steps = min(steps, math.floor(max(_gap_m(one, other), 0.0) / closing_m))
        return max(steps, 1)

    def settle(self) -> None:
        """After everybody has moved: who overlaps is put back to where it came from, and stands."""
        pairs = list(itertools.combinations(range(len(self._bodies)), 2))
        overlapping = self._overlapping(pairs)
        while overlapping:
            for pair in overlapping:
                if pair not in self._touching:
                    self._touching.add(pair)
                    for member in pair:
                        self._bodies[member].contacts += 1
            for member in sorted({member for pair in overlapping for member in pair}):
                self._bodies[member].step_back()
            overlapping = [pair for pair in self._overlapping(pairs) if not self._has_stepped_back(pair)]
        self._touching = {pair for pair in self._touching if self._gap_m(pair) <= _LEAVE_M}
        for body in self._bodies:
            body.has_stepped_back = False

    def _overlapping(self, pairs: Sequence[tuple[int, int]]) -> list[tuple[int, int]]:
        return [pair for pair in pairs if self._gap_m(pair) < -_TOUCH_M]

    def _has_stepped_back(self, pair: tuple[int, int]) -> bool:
        return all(self._bodies[member].has_stepped_back for member in pair)

    def _gap_m(self, pair: tuple[int, int]) -> float:
        return _gap_m(self._bodies[pair[0]], self._bodies[pair[1]])


def _gap_m(one: Body, other: Body) -> float:
    return math.dist(one.xy, other.xy) - one.radius_m - other.radius_m
