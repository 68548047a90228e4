"""Which people the robot touches, and whether it moved then."""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from explore_bt_drivers.people import Crowd
from explore_bt_drivers.people.ways import disc_at
from explore_bt_drivers.sim2d.body import Track
from explore_bt_drivers.sim2d.motion import STEP_S, V, X, Y

__all__ = ["Touches"]

_APART, _STOOD, _MET = range(3)
"""What is between the robot and a person: nothing, a touch while it stood, a touch while it moved."""

_LEAVE_M = 0.005
_MOVING_MPS = 0.05


class Touches:
    """Touches of one robot with the people of a crowd.

    Attributes:
        met: those during which the robot moved faster than 0.05 m/s.
    """

    def __init__(self, crowd: Crowd, footprint_m: float) -> None:
        self.met = 0
        self._crowd = crowd
        self._footprint_m = footprint_m
        self._touches = np.zeros(len(crowd), dtype=np.int8)
        self._over_at_rest = 0

    @property
    def at_rest(self) -> int:
        """Touches in which the robot has not moved, those that go on included."""
        return self._over_at_rest + int((self._touches == _STOOD).sum())

    def follow(self, track: Track, begin_step: int) -> None:
        """Follow the touches over the steps after ``begin_step`` up to the track's newest."""
        if not len(self._crowd):
            return
        met, stood = _meet(
            self._crowd.ways,
            track.states,
            track.first_step,
            begin_step,
            track.last_step,
            self._footprint_m,
            self._touches,
        )
        self.met += met
        self._over_at_rest += stood


@njit(cache=True)
def _meet(ways, states, first_step, begin, end, footprint, touches):  # type: ignore[no-untyped-def]  # kernel
    """Follow the touches of the footprint with people over the internal steps (begin, end].

    A touch lasts from an overlap until the two are 5 mm apart. ``touches`` is (K,) int8, what is between the
    robot and each person, and is brought up to date.

    Returns:
        In how many touches it first moved then, and how many ended in which it only stood.
    """
    met, stood = 0, 0
    for step in range(begin + 1, end + 1):
        x, y, speed = states[step - first_step, X], states[step - first_step, Y], states[step - first_step, V]
        for person in range(touches.shape[0]):
            px, py, _, _ = disc_at(ways, person, step * STEP_S)
            gap = math.hypot(px - x, py - y) - footprint - ways.radii[person]
            if touches[person] == _APART and gap < 0.0:
                touches[person] = _STOOD
            elif touches[person] != _APART and gap > _LEAVE_M:
                stood += touches[person] == _STOOD
                touches[person] = _APART
            if touches[person] == _STOOD and abs(speed) > _MOVING_MPS:
                touches[person] = _MET
                met += 1
    return met, stood
