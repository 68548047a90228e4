"""One axis of motion under limits of velocity, acceleration and jerk, in fixed steps."""

from __future__ import annotations

import math

from numba import njit

__all__ = ["Ramp", "driven"]

Ramp = tuple[float, float, int, int, float]
"""A set-point: begin, end, first step, number of steps, and where it may come to rest."""


@njit(cache=True)
def driven(ramp, step, v, a, limits, dt):  # type: ignore[no-untyped-def]  # kernel
    """Acceleration of an axis at the end of this step under its ramp; steps last ``dt`` seconds.

    ``v`` and ``a`` are the axis' state now, ``limits`` its largest velocity, acceleration and jerk.
    """
    goal, after = _ramp_at(ramp, step), _ramp_at(ramp, step + 1)
    slope = (after - goal) / dt
    return _next_acceleration(v, a, goal, slope, ramp[4], limits[0], limits[1], limits[2], dt)


@njit(cache=True)
def _largest_landing(gap, jerk, dt):  # type: ignore[no-untyped-def]  # kernel
    """The largest acceleration at the end of this step from which the gap is closed without overshoot.

    ``gap`` >= 0 is what remains of the way in velocity when half of this step's acceleration is spent.
    With constant jerk over each step, coming down from (n + f) jerk dt spends
    jerk dt² n (n + 1) / 2 + f jerk dt² (n + 1); this is the inverse of that.
    """
    unit = jerk * dt * dt
    n = math.floor((math.sqrt(1.0 + 8.0 * gap / unit) - 1.0) / 2.0)
    rest = (gap - unit * n * (n + 1) / 2.0) / (unit * (n + 1))
    return (n + rest) * jerk * dt


@njit(cache=True)
def _landing(gap, jerk, dt):  # type: ignore[no-untyped-def]  # kernel
    return math.copysign(_largest_landing(abs(gap), jerk, dt), gap)


@njit(cache=True)
def _ramp_at(ramp, step):  # type: ignore[no-untyped-def]  # kernel
    """Set-point of a ramp at an internal step."""
    begin, end, first, steps, _ = ramp
    if steps <= 0 or step >= first + steps:
        return end
    return begin + (end - begin) * (step - first) / steps


@njit(cache=True)
def _next_acceleration(v, a, goal, slope, rest, v_max, a_max, jerk, dt):  # type: ignore[no-untyped-def]  # kernel
    """Acceleration at the end of this step; it changes evenly over the step.

    The axis closes in on a set-point that stands at ``goal`` and moves at ``slope``, as fast as the
    limits let it and without passing it, nor ``rest``, where the set-point will come to rest at the
    earliest; it never enters a state that must break the speed limit. ``v`` and ``a`` are the state now;
    limits are > 0; SI throughout.
    """
    wanted = slope + _landing(goal - v - 0.5 * (a - slope) * dt, jerk, dt)
    if slope != 0.0:
        bound = _landing(rest - v - 0.5 * a * dt, jerk, dt)
        wanted = min(wanted, bound) if slope > 0.0 else max(wanted, bound)
    highest = _landing(v_max - v - 0.5 * a * dt, jerk, dt)
    lowest = -_landing(v_max + v + 0.5 * a * dt, jerk, dt)
    wanted = min(max(wanted, lowest, -a_max), highest, a_max)
    return min(max(wanted, a - jerk * dt), a + jerk * dt)
