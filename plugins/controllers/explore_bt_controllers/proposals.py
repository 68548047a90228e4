"""Motions worth trying before chance is asked: along the path, beside it, to rest, backwards."""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from explore_bt_controllers.feedback import turn_rate
from explore_bt_controllers.limiter import next_velocity
from explore_bt_controllers.rollout import World

__all__ = ["propose"]

_ON = 1e9
_LINES = (
    (0.0, 1.0, _ON),
    (0.0, 0.4, _ON),
    (0.0, 1.0, 1.6),
    (0.0, 1.0, 0.8),
    (0.0, 1.0, 0.4),
    (0.25, 1.0, _ON),
    (-0.25, 1.0, _ON),
    (0.5, 1.0, _ON),
    (-0.5, 1.0, _ON),
    (1.0, 0.7, _ON),
    (-1.0, 0.7, _ON),
)
"""Offset from the path as a share of the greatest one, share of the speed wanted there, seconds after which
it brakes: so it goes on until somebody is near, where else it would wait as soon as it sees them come."""
_turn_rate = njit(cache=True)(turn_rate)


def propose(world: World, steps: int, convergence_m: float, widest_m: float) -> NDArray[np.float32]:
    """(2, K, P) float32, m/s and rad/s: velocities to ask for, step after step.

    Args:
        world: what the motions will meet; only the path is looked at.
        steps: K.
        convergence_m: arc length over which an offset is taken up.
        widest_m: greatest offset from the path.
    """
    beside, shares, untils = np.array(_LINES).T * ((widest_m,), (1.0,), (1.0 / world.step_s,))
    asked = np.zeros((2, steps, len(_LINES) + 2), dtype=np.float32)
    _by_feedback(
        world.start, world.bounds, world.route, world.step_s, convergence_m, beside, shares, untils, asked
    )
    asked[0, :, -1] = world.bounds.lowest
    return asked


@njit(cache=True)
def _by_feedback(start, bounds, route, step_s, convergence_m, beside, shares, untils, asked):  # type: ignore[no-untyped-def]  # numba kernel
    """Fills ``asked`` with what ``pursuit``'s feedback would ask for along a line beside the path."""
    for p in range(len(beside)):
        x, y, yaw, along = start.x, start.y, start.yaw, start.along
        v, a, w, b = start.linear, start.linear_gain, start.angular, start.angular_gain
        for k in range(asked.shape[1]):
            i = int(min(max(along / route.spacing, 0.0), len(route.samples) - 1.0))
            px, py, tx, ty, bend, change, wanted = route.samples[i]
            ex, ey = x - px, y - py
            lateral = ey * tx - ex * ty
            error = math.atan2(
                math.sin(yaw) * tx - math.cos(yaw) * ty, math.cos(yaw) * tx + math.sin(yaw) * ty
            )
            target = shares[p] * wanted if k < untils[p] else 0.0
            rate = _turn_rate(max(v, 0.1), lateral - beside[p], error, bend, change, convergence_m)
            rate = min(max(rate, -bounds.turn_rate), bounds.turn_rate)
            asked[0, k, p], asked[1, k, p] = target, rate
            next_v = next_velocity(
                v, a, target, 0.0, step_s, bounds.lowest, bounds.highest, bounds.acceleration, bounds.jerk
            )
            next_w = next_velocity(
                w, b, rate, 0.0, step_s,
                -bounds.turn_rate, bounds.turn_rate, bounds.turn_acceleration, bounds.turn_jerk,
            )  # fmt: skip
            way, turn = 0.5 * (v + next_v) * step_s, 0.5 * (w + next_w) * step_s
            a, b, v, w = (next_v - v) / step_s, (next_w - w) / step_s, next_v, next_w
            x += way * math.cos(yaw + 0.5 * turn)
            y += way * math.sin(yaw + 0.5 * turn)
            yaw += turn
            along = i * route.spacing + ex * tx + ey * ty + way * math.cos(error)
