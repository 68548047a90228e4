"""One velocity under limits of velocity, acceleration and jerk, period by period.

A command is reached linearly within its period, so acceleration is constant over a period and may change
by ``jerk · dt`` from one to the next. Periods may differ. All laws here rest on one fact: a velocity with
acceleration a can still level off within a²/2j, whatever periods come, because the sum of a falling
sequence taken at the right ends of its periods is below its integral.
"""

from __future__ import annotations

import math

from numba import njit

__all__ = ["approach", "next_velocity", "within"]


@njit(cache=True)
def approach(gap, dt, jerk):  # type: ignore[no-untyped-def]  # numba kernel
    """The strongest acceleration now that still allows to level off at ``gap`` without passing it.

    Solves ``a·dt + a²/2j = gap``; odd in ``gap``, so that both directions are served alike. In the precision
    of what is given: no number is written here that would widen it.
    """
    way = abs(gap)
    size = jerk * (math.sqrt(dt * dt + (way + way) / jerk) - dt)
    return math.copysign(size, gap)


@njit(cache=True)
def within(wanted, acceleration, dt, max_acceleration, jerk):  # type: ignore[no-untyped-def]  # numba kernel
    """The acceleration nearest to the wanted one that its own limit allows, and before that the jerk."""
    wanted = max(-max_acceleration, min(max_acceleration, wanted))
    return max(acceleration - jerk * dt, min(acceleration + jerk * dt, wanted))


@njit(cache=True)
def next_velocity(  # type: ignore[no-untyped-def]  # numba kernel
    velocity, acceleration, target, target_acceleration, dt, lowest, highest, max_acceleration, jerk
):
    """The velocity to command for the next period on the way to a moving target.

    Jerk goes before acceleration, acceleration before velocity: a state that already breaks a limit (it
    was cut, or a stronger brake was at work) is led back under it as fast as the others allow.

    Args:
        velocity: last commanded.
        acceleration: its change over the last period, per second.
        target: velocity wanted at the end of the period.
        target_acceleration: how fast the target moves.
        dt: the period, seconds.
        lowest: least velocity allowed.
        highest: greatest velocity allowed.
        max_acceleration: magnitude.
        jerk: magnitude.
    """
    gap = target - velocity - target_acceleration * dt
    wanted = target_acceleration + approach(gap, dt, jerk)
    wanted = max(approach(lowest - velocity, dt, jerk), min(approach(highest - velocity, dt, jerk), wanted))
    after = velocity + within(wanted, acceleration, dt, max_acceleration, jerk) * dt
    # the approach halves its number of digits each period; end it where it no longer means anything
    return target if abs(after - target) < 1e-9 else after
