"""The body's motion in fixed steps: limited unicycle, exact arcs, a footprint that does not penetrate."""

from __future__ import annotations

import math

from numba import njit

from explore_bt_drivers.orders import driven
from explore_bt_drivers.world.index import nearest

__all__ = [
    "ACC",
    "ON_STEP",
    "STEP_S",
    "YAW",
    "V",
    "W",
    "X",
    "Y",
    "advance",
    "place_at",
    "states_at",
    "value_at",
]

STEP_S = 0.01
"""Length of an internal step, seconds: state k belongs to time k * STEP_S."""

X, Y, YAW, V, ACC, W, TURN_ACC = range(7)
"""Columns of a state row: m, m, rad (unwrapped), m/s, m/s², rad/s, rad/s²."""

ON_STEP = 1e-6
"""A time this near to a step's (in steps) is that step's."""

_TOUCH_M = 1e-6
_LEAVE_M = 0.005
_HALVINGS = 20


@njit(cache=True)
def advance(index, states, row, count, step, linear, angular, limits, radius, touching):  # type: ignore[no-untyped-def]  # kernel
    """Write ``count`` states after ``states[row]``, which belongs to internal step ``step``.

    ``states`` is (N, 7) float64 with the columns above; ``linear`` and ``angular`` are the ramps
    (begin, end, first step, steps, rest) of the set-points; ``limits`` are speed, acceleration, jerk, turn
    rate, turn acceleration, turn jerk; ``touching`` tells whether the footprint touches something now.

    Returns:
        Whether it touches at the end, and how many separate touches began.
    """
    dt = STEP_S
    contacts = 0
    for k in range(row, row + count):
        x, y, yaw, v, acc, w, turn_acc = states[k]
        acc_next = driven(linear, step, v, acc, limits[:3], dt)
        turn_acc_next = driven(angular, step, w, turn_acc, limits[3:], dt)
        v_next = v + 0.5 * (acc + acc_next) * dt
        w_next = w + 0.5 * (turn_acc + turn_acc_next) * dt
        x_next, y_next, yaw_next = _arc(x, y, yaw, 0.5 * (v + v_next) * dt, 0.5 * (w + w_next) * dt)
        distance, _ = nearest(index, x_next, y_next, radius + 2.0 * _LEAVE_M)
        if distance < radius - _TOUCH_M:
            x_next, y_next = _halt_at_touch(index, x, y, x_next, y_next, radius)
            v_next, acc_next = 0.0, 0.0
            contacts += not touching
            touching = True
        elif distance > radius + _LEAVE_M:
            touching = False
        states[k + 1] = (x_next, y_next, yaw_next, v_next, acc_next, w_next, turn_acc_next)
        step += 1
    return touching, contacts


@njit(cache=True)
def _arc(x, y, yaw, length, turn):  # type: ignore[no-untyped-def]  # kernel
    """The pose after driving ``length`` metres while turning evenly by ``turn`` radians: exact."""
    half = 0.5 * turn
    chord = length * (math.sin(half) / half if abs(half) > 1e-9 else 1.0)
    return x + chord * math.cos(yaw + half), y + chord * math.sin(yaw + half), yaw + turn


@njit(cache=True)
def _halt_at_touch(index, x, y, x_next, y_next, radius):  # type: ignore[no-untyped-def]  # kernel
    """The last place on the way at which the footprint still fits."""
    low, high = 0.0, 1.0
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        px, py = x + middle * (x_next - x), y + middle * (y_next - y)
        distance, _ = nearest(index, px, py, radius)
        if distance < radius - _TOUCH_M:
            high = middle
        else:
            low = middle
    return x + low * (x_next - x), y + low * (y_next - y)


@njit(cache=True)
def place_at(time, first_step, rows):  # type: ignore[no-untyped-def]  # kernel
    """The row before a time and the share of the step gone by; a step's own time gives its row exactly.

    Rounding must not decide between a row and its neighbour: at the end of what is known there is none,
    and a measurement would then depend on how far the world has been moved on when it is taken.
    """
    place = time / STEP_S - first_step
    row = round(place)
    if abs(place - row) < ON_STEP:
        return min(max(row, 0), rows - 1), 0.0
    row = math.floor(place)
    return min(max(row, 0), rows - 2), place - row


@njit(cache=True)
def value_at(states, row, share, column):  # type: ignore[no-untyped-def]  # kernel
    """A column's value ``share`` of a step after a row, by a straight line."""
    value = states[row, column]
    return value + share * (states[row + 1, column] - value) if share > 0.0 else value


@njit(cache=True)
def states_at(states, first_step, times, out):  # type: ignore[no-untyped-def]  # kernel
    """States at (N,) times, by straight lines between steps; ``states[0]`` is ``first_step``."""
    for i in range(times.shape[0]):
        row, share = place_at(times[i], first_step, states.shape[0])
        for column in range(states.shape[1]):
            out[i, column] = value_at(states, row, share, column)
