"""Many sampled motions rolled out at once, and what each of them costs."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from explore_bt_controllers.limiter import approach, within

__all__ = ["Bounds", "Field", "Prices", "Route", "Start", "World", "costs_of"]

_BLOCK = 128  # samples rolled out together: their state stays in the nearest cache
_DEVIATION_M = 0.15  # offset at which deviating costs half of its price
_SLOW_MPS = 0.05  # places to be driven no faster are alike
_LEAST_SHRINK = 0.3  # of 1 - curvature · offset: beyond it the projection would jump
_AT_REST = 0.02  # part of the price of being touched that is due at rest too


class Start(NamedTuple):
    """State of the robot: pose (metres, radians), twist and its change, arc length on the leg (metres)."""

    x: float
    y: float
    yaw: float
    linear: float
    linear_gain: float
    angular: float
    angular_gain: float
    along: float


class Bounds(NamedTuple):
    """Limits of the rollouts; velocities are between ``lowest`` and ``highest``, the rest are magnitudes."""

    lowest: float
    highest: float
    acceleration: float
    jerk: float
    turn_rate: float
    turn_acceleration: float
    turn_jerk: float


class Route(NamedTuple):
    """The leg: (N, 7) float64 x, y, unit tangent x, y, curvature, its rate, wanted speed; SI units."""

    samples: NDArray[np.float64]
    spacing: float


class Field(NamedTuple):
    """(R, C) float32 metres to the nearest static obstacle, at cell centres.

    ``x0``, ``y0`` is the centre of cell (0, 0); beyond its edge the field goes on as at the edge.
    """

    room: NDArray[np.float32]
    x0: float
    y0: float
    resolution: float


class Prices(NamedTuple):
    """What a second of each thing costs; distances in metres are counted from the centre of the robot.

    Attributes:
        widest: offset from the path, metres.
        hard, soft: room, metres.
        speed: standing still where the path is to be driven at full speed; where it is to be driven slowly,
            lagging behind by a share of that speed costs that share of it.
        deviation: being far from the path; half of it at 0.15 m.
        offset: each metre from the path.
        beyond: each metre further than ``widest``.
        heading: facing away from the path, by 1 - cos.
        acceleration, turn_acceleration: their squares.
        reverse: each metre per second backwards.
        room: full speed with no more than ``hard`` of room, falling to none at ``soft``.
        touch: being nearer to an obstacle than ``hard``.
        depth: each metre nearer than that.
        near: being at the inner edge of the band around a moving obstacle.
    """

    widest: float
    hard: float
    soft: float
    speed: float = 2.0
    deviation: float = 0.5
    offset: float = 0.3
    beyond: float = 60.0
    heading: float = 0.3
    acceleration: float = 0.1
    turn_acceleration: float = 0.02
    reverse: float = 2.0
    room: float = 1.0
    touch: float = 60.0
    depth: float = 200.0
    near: float = 2.0


class World(NamedTuple):
    """All that a sampled motion meets.

    Attributes:
        moving: (K, M, 4) float64, the moving obstacles after each step, see ``Nearby.moving_at``.
        step_s: seconds of each of the K steps.
    """

    start: Start
    bounds: Bounds
    route: Route
    field: Field
    moving: NDArray[np.float64]
    prices: Prices
    step_s: float


@njit(cache=True, fastmath=True, error_model="numpy")
def costs_of(world, targets, noise, first_v, first_w, count):  # type: ignore[no-untyped-def]  # numba kernel
    """Cost of each sampled motion.

    A sample asks for the velocities ``targets + noise`` step after step and gets what the limits of
    velocity, acceleration and jerk leave of it, by the same law that limits the commands. All samples of a
    block take each step together, in loops short enough for the compiler to vectorise.

    Args:
        world: see ``World``.
        targets: (2, K) float64, m/s and rad/s.
        noise: (2, K, B) float32, m/s and rad/s, a bank of sequences.
        first_v: sample n takes column ``first_v + n`` of the bank for its linear velocity;
        first_w: and column ``first_w + n`` for its turn rate.
        count: N, how many samples.

    Returns:
        (N,) float64.
    """
    start, bounds, route, field, moving, prices, step_s = world
    total = np.zeros(count)
    x, y, c, s = np.empty(_BLOCK), np.empty(_BLOCK), np.empty(_BLOCK), np.empty(_BLOCK)
    v, a, w, b = np.empty(_BLOCK), np.empty(_BLOCK), np.empty(_BLOCK), np.empty(_BLOCK)
    way, turn, cost, room = np.empty(_BLOCK), np.empty(_BLOCK), np.empty(_BLOCK), np.empty(_BLOCK)
    arc, lateral, facing, wanted = np.empty(_BLOCK), np.empty(_BLOCK), np.empty(_BLOCK), np.empty(_BLOCK)
    for first in range(0, count, _BLOCK):
        size = min(_BLOCK, count - first)
        x[:], y[:], arc[:], cost[:] = start.x, start.y, start.along, 0.0
        c[:], s[:] = np.cos(start.yaw), np.sin(start.yaw)
        v[:], a[:] = start.linear, start.linear_gain
        w[:], b[:] = start.angular, start.angular_gain
        for k in range(targets.shape[1]):
            asked_v = noise[0, k, first_v + first : first_v + first + size]
            asked_w = noise[1, k, first_w + first : first_w + first + size]
            _accelerate(
                v, a, way, targets[0, k], asked_v, step_s,
                bounds.lowest, bounds.highest, bounds.acceleration, bounds.jerk,
            )  # fmt: skip
            _accelerate(
                w, b, turn, targets[1, k], asked_w, step_s,
                -bounds.turn_rate, bounds.turn_rate, bounds.turn_acceleration, bounds.turn_jerk,
            )  # fmt: skip
            _move(x, y, c, s, way, turn, size)
            _place(arc, lateral, facing, wanted, x, y, c, s, way, route.samples, route.spacing, size)
            _look_up(room, x, y, field.room, field.x0, field.y0, field.resolution, size)
            _charge(cost, v, a, b, lateral, facing, wanted, room, prices, bounds.highest, size)
            for m in range(moving.shape[1]):
                _charge_moving(cost, x, y, v, moving[k, m], prices, bounds.highest, size)
        total[first : first + size] = step_s * cost[:size]
    return total


@njit(cache=True, fastmath=True, error_model="numpy")
def _accelerate(v, a, way, target, asked, step_s, lowest, highest, acceleration, jerk):  # type: ignore[no-untyped-def]  # numba kernel
    """One step of one velocity; ``way`` is how far it leads.

    This is ``next_velocity`` for a target that rests: then the range of velocities may cut the target, which
    saves two roots in three.
    """
    for n in range(asked.size):
        aim = min(max(target + asked[n], lowest), highest)
        gain = within(approach(aim - v[n], step_s, jerk), a[n], step_s, acceleration, jerk)
        after = v[n] + gain * step_s
        way[n] = 0.5 * (v[n] + after) * step_s
        v[n], a[n] = after, gain


@njit(cache=True, fastmath=True, error_model="numpy")
def _move(x, y, c, s, way, turn, size):  # type: ignore[no-untyped-def]  # numba kernel
    """Along the chord of the arc; c, s are cosine and sine of the heading, by their series."""
    for n in range(size):
        half = 0.5 * turn[n]
        square = half * half
        ch, sh = 1.0 - square * (0.5 - square / 24.0), half * (1.0 - square * (1.0 / 6.0 - square / 120.0))
        middle_c, middle_s = c[n] * ch - s[n] * sh, s[n] * ch + c[n] * sh
        x[n] += way[n] * middle_c
        y[n] += way[n] * middle_s
        c[n], s[n] = middle_c * ch - middle_s * sh, middle_s * ch + middle_c * sh


@njit(cache=True, fastmath=True, error_model="numpy")
def _place(arc, lateral, facing, wanted, x, y, c, s, way, route, spacing, size):  # type: ignore[no-untyped-def]  # numba kernel
    """Projects on the leg by one Newton step from where the last place and the way driven point to."""
    last = float(route.shape[0] - 1)
    for n in range(size):
        i = np.uintp(min(max((arc[n] + way[n]) / spacing, 0.0), last))
        tx, ty = route[i, 2], route[i, 3]
        ex, ey = x[n] - route[i, 0], y[n] - route[i, 1]
        off = ey * tx - ex * ty
        shrink = max(1.0 - route[i, 4] * off, _LEAST_SHRINK)
        arc[n] = i * spacing + (ex * tx + ey * ty) / shrink
        lateral[n] = off
        facing[n] = c[n] * tx + s[n] * ty
        wanted[n] = route[i, 6]


@njit(cache=True, fastmath=True, error_model="numpy")
def _look_up(room, x, y, field, x0, y0, resolution, size):  # type: ignore[no-untyped-def]  # numba kernel
    """Bilinear."""
    width, cells = np.int32(field.shape[1]), field.reshape(-1)
    top, right = field.shape[0] - 1.001, field.shape[1] - 1.001
    for n in range(size):
        fx = min(max((x[n] - x0) / resolution, 0.0), right)
        fy = min(max((y[n] - y0) / resolution, 0.0), top)
        i, j = np.int32(fy), np.int32(fx)
        px, py = fx - np.float64(j), fy - np.float64(i)
        k = i * width + j
        room[n] = (1.0 - py) * ((1.0 - px) * cells[k] + px * cells[k + 1]) + py * (
            (1.0 - px) * cells[k + width] + px * cells[k + width + 1]
        )


@njit(cache=True, fastmath=True, error_model="numpy")
def _charge(cost, v, a, b, lateral, facing, wanted, room, prices, highest, size):  # type: ignore[no-untyped-def]  # numba kernel
    """Everything but what moves."""
    lag_price, band = prices.speed / highest, prices.soft - prices.hard
    for n in range(size):
        lag = wanted[n] - v[n] * facing[n]
        off, square = abs(lateral[n]), lateral[n] * lateral[n]
        tight = min(max((prices.soft - room[n]) / band, 0.0), 1.0) * v[n] / highest
        short = prices.hard - room[n]
        cost[n] += (
            lag_price * lag * lag / (wanted[n] + _SLOW_MPS)
            + prices.deviation * square / (square + _DEVIATION_M * _DEVIATION_M)
            + prices.offset * off
            + prices.beyond * max(off - prices.widest, 0.0)
            + prices.heading * (1.0 - facing[n])
            + prices.acceleration * a[n] * a[n]
            + prices.turn_acceleration * b[n] * b[n]
            + prices.reverse * max(-v[n], 0.0)
            + prices.room * tight * tight
            + (prices.touch + prices.depth * short if short > 0.0 else 0.0)
        )


@njit(cache=True, fastmath=True, error_model="numpy")
def _charge_moving(cost, x, y, v, disc, prices, highest, size):  # type: ignore[no-untyped-def]  # numba kernel
    """Being touched at rest is not the robot's doing, so haste counts."""
    for n in range(size):
        dx, dy = x[n] - disc[0], y[n] - disc[1]
        spare = np.sqrt(dx * dx + dy * dy) - disc[2]
        close = min(max(1.0 - spare / disc[3], 0.0), 1.0)
        touch = prices.touch - prices.depth * spare if spare < 0.0 else 0.0
        cost[n] += prices.near * close * close + touch * (_AT_REST + abs(v[n]) / highest)
