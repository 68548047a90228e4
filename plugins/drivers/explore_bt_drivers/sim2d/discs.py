"""People as discs on known ways: where they are, which beams meet them, which of them the robot touches."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from explore_bt_drivers.sim2d.motion import STEP_S, YAW, V, X, Y, place_at, value_at

__all__ = ["APART", "MET", "STOOD", "Ways", "cast_at_discs", "disc_at", "meet"]

APART, STOOD, MET = range(3)
"""What is between the robot and a person: nothing, a touch while it stood, a touch while it moved."""

_LEAVE_M = 0.005
_MOVING_MPS = 0.05


class Ways(NamedTuple):
    """Broken lines in space and time, one a person; between knots they go at constant speed.

    Attributes:
        knots: (N, 3) float64: seconds (ascending for each person), x, y in metres, ``map`` frame.
        starts: (K + 1,) int64; person k has ``knots[starts[k]:starts[k + 1]]``, two or more of them.
        radii: (K,) float64, metres.
    """

    knots: NDArray[np.float64]
    starts: NDArray[np.int64]
    radii: NDArray[np.float64]


@njit(cache=True)
def disc_at(ways, person, time):  # type: ignore[no-untyped-def]  # kernel
    """x, y, vx, vy of a person; before the first knot they stand there."""
    low, high = ways.starts[person], ways.starts[person + 1] - 1
    if time < ways.knots[low, 0]:
        return ways.knots[low, 1], ways.knots[low, 2], 0.0, 0.0
    while high - low > 1:
        middle = (low + high) // 2
        if ways.knots[middle, 0] <= time:
            low = middle
        else:
            high = middle
    begin, x, y = ways.knots[low]
    end, x_end, y_end = ways.knots[high]
    vx, vy = (x_end - x) / (end - begin), (y_end - y) / (end - begin)
    return x + vx * (time - begin), y + vy * (time - begin), vx, vy


@njit(cache=True)
def cast_at_discs(ways, states, first_step, stamp, times, angles, limit, ranges):  # type: ignore[no-untyped-def]  # kernel
    """Shorten the ranges of the beams of a sweep that meet a person before anything else.

    Robot and people are where they are at each beam's own time. A beam that begins inside a person passes
    through that person.

    Returns:
        (N,) bool: the beams that now end at a person.
    """
    shown = np.zeros(angles.shape[0], dtype=np.bool_)
    for i in range(angles.shape[0]):
        time = stamp + times[i]
        row, share = place_at(time, first_step, states.shape[0])
        x, y = value_at(states, row, share, X), value_at(states, row, share, Y)
        direction = value_at(states, row, share, YAW) + angles[i]
        dx, dy = math.cos(direction), math.sin(direction)
        for person in range(ways.radii.shape[0]):
            px, py, _, _ = disc_at(ways, person, time)
            ex, ey, radius = px - x, py - y, ways.radii[person]
            outside = ex * ex + ey * ey - radius * radius
            ahead = dx * ex + dy * ey
            if outside <= 0.0 or ahead <= 0.0 or ahead * ahead < outside:
                continue
            # the nearer root of t² - 2 ahead t + outside = 0, in the form that does not cancel
            t = outside / (ahead + math.sqrt(ahead * ahead - outside))
            if t < ranges[i] and t <= limit:
                ranges[i] = t
                shown[i] = True
    return shown


@njit(cache=True)
def meet(ways, states, first_step, begin, end, footprint, touches):  # type: ignore[no-untyped-def]  # kernel
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
            if touches[person] == APART and gap < 0.0:
                touches[person] = STOOD
            elif touches[person] != APART and gap > _LEAVE_M:
                stood += touches[person] == STOOD
                touches[person] = APART
            if touches[person] == STOOD and abs(speed) > _MOVING_MPS:
                touches[person] = MET
                met += 1
    return met, stood
