"""The jerk-limited brake: how a velocity comes to zero, in closed form.

Velocity and acceleration go from (v, a) to (0, 0) in the shortest time with |a| <= a_max and
|jerk| <= j_max: the acceleration ramps to a peak, stays there, ramps back. The same profile serves the
safety gate's look-ahead and the commands it sends, so what was checked is what is driven.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

__all__ = ["brake_duration_s", "brake_velocity"]


@njit(cache=True)
def _profile(v: float, a: float, a_max: float, j_max: float) -> tuple[float, float, float, float, float]:
    """Times of the three phases, the first jerk, and the peak acceleration."""
    resting_v = v + a * abs(a) / (2.0 * j_max)
    if resting_v == 0.0 and a == 0.0:
        return 0.0, 0.0, 0.0, 0.0, 0.0
    sign = -1.0 if resting_v > 0.0 else 1.0
    peak = math.sqrt(max(0.0, -sign * v * j_max + 0.5 * a * a))
    peak = min(peak, a_max)
    ramp = sign * peak - a
    jerk = j_max if ramp > 0.0 else -j_max
    t1 = abs(ramp) / j_max
    t3 = peak / j_max
    v_after_ramps = v + a * t1 + 0.5 * jerk * t1 * t1 + 0.5 * sign * peak * t3
    t2 = max(0.0, -v_after_ramps / (sign * peak)) if peak > 0.0 else 0.0
    return t1, t2, t3, jerk, sign * peak


@njit(cache=True)
def brake_duration_s(v: float, a: float, a_max: float, j_max: float) -> float:
    """Seconds until velocity and acceleration are zero.

    Args:
        v: velocity now, m/s or rad/s.
        a: acceleration now; beyond ``a_max`` it is brought back first.
        a_max: the largest acceleration, > 0.
        j_max: the largest jerk, > 0.
    """
    t1, t2, t3, _, _ = _profile(v, a, a_max, j_max)
    return t1 + t2 + t3


@njit(cache=True)
def brake_velocity(
    v: float, a: float, a_max: float, j_max: float, times_s: NDArray[np.float64]
) -> NDArray[np.float64]:
    """The velocity at ``times_s`` (N,) after the brake began; zero once it is over."""
    t1, t2, t3, jerk, peak = _profile(v, a, a_max, j_max)
    v1 = v + a * t1 + 0.5 * jerk * t1 * t1
    v2 = v1 + peak * t2
    out = np.zeros(times_s.shape[0])
    for i in range(times_s.shape[0]):
        t = times_s[i]
        if t < t1:
            out[i] = v + a * t + 0.5 * jerk * t * t
        elif t < t1 + t2:
            out[i] = v1 + peak * (t - t1)
        elif t < t1 + t2 + t3:
            rest = t - t1 - t2
            out[i] = v2 + peak * rest - 0.5 * peak / t3 * rest * rest
    return out
