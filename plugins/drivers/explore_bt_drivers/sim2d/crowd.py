"""The people in a robot's world, as far as their ways are known yet."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from explore_bt_drivers.sim2d.body import Track
from explore_bt_drivers.sim2d.discs import STOOD, Ways, cast_at_discs, disc_at, meet
from explore_bt_drivers.sim2d.motion import STEP_S
from explore_bt_drivers.sim2d.walks import Knot, Walk

__all__ = ["Crowd"]

_MEMORY_S = 5.0
"""Ways stay known for so long: more than the longest sweep (2 s) and the longest stretch of steps (1 s)."""


class Crowd:
    """Discs on their walks, which do not react to anything, and their touches with one robot.

    Attributes:
        contacts: touches with people during which the robot moved faster than 0.05 m/s.
    """

    def __init__(self, walks: Sequence[Walk], footprint_m: float) -> None:
        self.contacts = 0
        self._walks = walks
        self._footprint_m = footprint_m
        self._known = [deque((next(walk.knots), next(walk.knots))) for walk in walks]
        self._touches = np.zeros(len(walks), dtype=np.int8)
        self._touches_at_rest = 0
        self._ways = self._gathered()

    @property
    def touches_at_rest(self) -> int:
        """Touches in which the robot has not moved, those that go on included."""
        return self._touches_at_rest + int((self._touches == STOOD).sum())

    def foresee(self, last_step: int) -> None:
        """Know all ways up to an internal step, and forget what nobody asks about any more."""
        if not self._walks:
            return
        changed = [
            _extend(knots, walk, last_step * STEP_S)
            for knots, walk in zip(self._known, self._walks, strict=True)
        ]
        if any(changed):
            self._ways = self._gathered()

    def meet(self, track: Track, begin_step: int) -> None:
        """Follow the touches over the steps after ``begin_step`` up to the track's newest."""
        if not self._walks:
            return
        met, stood = meet(
            self._ways,
            track.states,
            track.first_step,
            begin_step,
            track.last_step,
            self._footprint_m,
            self._touches,
        )
        self.contacts += met
        self._touches_at_rest += stood

    def cast(
        self,
        track: Track,
        stamp_s: float,
        times_s: NDArray[np.float64],
        angles_rad: NDArray[np.float64],
        limit_m: float,
        ranges_m: NDArray[np.float64],
    ) -> NDArray[np.bool_] | None:
        """Shorten the ranges of a sweep where people are in the way.

        Returns:
            (N,) bool: the beams that now end at a person; None where nobody is about.
        """
        if not self._walks:
            return None
        return np.asarray(
            cast_at_discs(
                self._ways, track.states, track.first_step, stamp_s, times_s, angles_rad, limit_m, ranges_m
            )
        )

    def at(self, time_s: float) -> NDArray[np.float64]:
        """(K, 5) float64: x, y, vx, vy, radius of everybody; metres and seconds, ``map`` frame."""
        rows = [
            (*disc_at(self._ways, person, time_s), walk.radius_m) for person, walk in enumerate(self._walks)
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
