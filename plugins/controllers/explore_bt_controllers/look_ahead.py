"""How fast a robot may go now, given where it has to be slow later."""

from __future__ import annotations

from numba import njit

from explore_bt_controllers.limiter import approach, within

__all__ = ["fastest_velocity"]

_TOLERANCE_MPS = 1e-3
_TOLERANCE_M = 1e-4
_BISECTIONS = 10
_ROLLOUT_S = 0.02  # a brake in shorter periods is the later one: it must not be promised too early
_LONGEST_BRAKE = 600


@njit(cache=True)
def fastest_velocity(  # type: ignore[no-untyped-def]  # numba kernel
    velocity, acceleration, cap, along, limits, spacing, length, dt, highest, max_acceleration, jerk
):
    """The greatest next velocity from which the hardest brake keeps every limit ahead.

    The brake is rolled out period by period under acceleration and jerk; if one is possible after this
    period, the next period has at least that brake to fall back on. This is the jerk-aware form of the
    usual backward pass, without its assumption that braking begins at full strength.

    Args:
        velocity: last commanded, m/s.
        acceleration: its change over the last period, m/s².
        cap: velocity wanted at most, m/s; approached, not forced.
        along: arc length of the robot, metres.
        limits: (N,) float64 m/s, largest velocity on each piece of the path; 0 beyond ``length``.
        spacing: metres of each piece.
        length: arc length of the path, metres.
        dt: the period, seconds.
        highest: largest velocity at all, m/s.
        max_acceleration: m/s².
        jerk: m/s³.
    """
    low = _brake(velocity, acceleration, dt, max_acceleration, jerk)
    high = min(max_acceleration, approach(min(highest, cap) - velocity, dt, jerk))
    high = max(low, min(acceleration + jerk * dt, high))
    if _keeps(velocity, high, along, limits, spacing, length, dt, max_acceleration, jerk):
        return velocity + high * dt
    if not _keeps(velocity, low, along, limits, spacing, length, dt, max_acceleration, jerk):
        return _ended(velocity + low * dt)
    for _ in range(_BISECTIONS):
        middle = 0.5 * (low + high)
        if _keeps(velocity, middle, along, limits, spacing, length, dt, max_acceleration, jerk):
            low = middle
        else:
            high = middle
    return _ended(velocity + low * dt)


@njit(cache=True)
def _brake(velocity, acceleration, dt, max_acceleration, jerk):  # type: ignore[no-untyped-def]  # numba kernel
    """The strongest acceleration towards rest that does not pass it."""
    return within(approach(-velocity, dt, jerk), acceleration, dt, max_acceleration, jerk)


@njit(cache=True)
def _ended(velocity):  # type: ignore[no-untyped-def]  # numba kernel
    return 0.0 if abs(velocity) < 1e-9 else velocity


@njit(cache=True)
def _keeps(velocity, acceleration, along, limits, spacing, length, dt, max_acceleration, jerk):  # type: ignore[no-untyped-def]  # numba kernel
    """Whether one period at ``acceleration`` and the hardest brake after it keep the limits."""
    for _ in range(_LONGEST_BRAKE):
        after = velocity + acceleration * dt
        along += 0.5 * (velocity + after) * dt
        velocity = after
        if velocity <= _TOLERANCE_MPS:
            return along <= length + _TOLERANCE_M
        if along >= length:
            return False
        if velocity > limits[min(max(int(along / spacing), 0), len(limits) - 1)] + _TOLERANCE_MPS:
            return False
        dt = min(dt, _ROLLOUT_S)
        acceleration = _brake(velocity, acceleration, dt, max_acceleration, jerk)
    return False
