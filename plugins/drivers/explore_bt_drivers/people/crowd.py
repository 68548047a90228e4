"""The people in a robot's world, as far as their ways are known yet."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from explore_bt_drivers.people.walks import Knot, Walk
from explore_bt_drivers.people.ways import Ways, disc_at

__all__ = ["Crowd"]

_MEMORY_S = 5.0
"""Ways stay known for so long: more than the longest sweep (2 s) and the longest stretch of steps (1 s)."""


class Crowd:
    """Discs on their walks, which do not react to anything.

    Attributes:
        ways: where they go, from some seconds ago up to the time that was foreseen.
    """

    def __init__(self, walks: Sequence[Walk]) -> None:
        self._walks = walks
        self._known = [deque((next(walk.knots), next(walk.knots))) for walk in walks]
        self.ways = self._gathered()

    def __len__(self) -> int:
        return len(self._walks)

    def foresee(self, time_s: float) -> None:
        """Know all ways up to a time, and forget what nobody asks about any more."""
        if not self._walks:
            return
        changed = [_extend(knots, walk, time_s) for knots, walk in zip(self._known, self._walks, strict=True)]
        if any(changed):
            self.ways = self._gathered()

    def at(self, time_s: float) -> NDArray[np.float64]:
        """(K, 5) float64: x, y, vx, vy, radius of everybody; metres and seconds, ``map`` frame."""
        rows = [
            (*disc_at(self.ways, person, time_s), walk.radius_m) for person, walk in enumerate(self._walks)
        ]
        return np.array(rows, dtype=np.float64).reshape(-1, 5)

    def _gathered(self) -> Ways:
        counts = [len(knots) for knots in self._known]
        return Ways(
            np.array([knot for knots in self._known for knot in knots], dtype=np.float64).reshape(-1, 3),
            np.cumsum([0, *counts], dtype=np.int64),
            np.array([walk.radius_m for walk in self._walks], dtype=np.float64),
        )


def _extend(knots: deque[Knot], walk: Walk, time_s: float) -> bool:
    """Know one way beyond a time, and forget what lies too far back; whether that changed anything."""
    before = (len(knots), knots[0])
    while knots[-1][0] <= time_s:
        knots.append(next(walk.knots))
    while len(knots) > 2 and knots[1][0] < time_s - _MEMORY_S:
        knots.popleft()
    return before != (len(knots), knots[0])
