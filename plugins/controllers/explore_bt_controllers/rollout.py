"""Many sampled motions rolled out at once, and what each of them costs."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from explore_bt_controllers.limiter import approach, within

__all__ = ["BLOCK", "Bounds", "Field", "Prices", "Route", "Start", "World", "costs_of"]

_F = np.float32  # kernels compute in single precision, of which a register holds twice as many

BLOCK = 128
"""Samples rolled out together: their state stays in the nearest cache, and loops of known length are fast."""
_APART = 16  # rows a power of two apart would be in each other's way in the cache
_DEVIATION_M = _F(0.15)  # offset at which deviating costs half of its price
_SLOW_MPS = _F(0.05)  # places to be driven no faster are alike
_LEAST_SHRINK = _F(0.3)  # of 1 - curvature · offset: beyond it the projection would jump
_AT_REST = _F(0.02)  # part of the price of being touched that is due at rest too
_NONE, _HALF, _ALL = _F(0.0), _F(0.5), _F(1.0)
_SIXTH, _24TH, _120TH = _F(1.0 / 6.0), _F(1.0 / 24.0), _F(1.0 / 120.0)


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


def costs_of(
    world: World,
    targets: NDArray[np.float64],
    noise: NDArray[np.float32],
    firsts: tuple[int, int],
    count: int,
) -> NDArray[np.float64]:
    """Cost of each sampled motion.

    A sample asks for the velocities ``targets + noise`` step after step and gets what the limits of
    velocity, acceleration and jerk leave of it, by the same law that limits the commands. All samples of a
    block take each step together, in loops short enough for the compiler to vectorise.

    Args:
        world: see ``World``.
        targets: (2, K) float64, m/s and rad/s.
        noise: (2, G, K, BLOCK) float32, m/s and rad/s, a bank of G blocks of sequences.
        firsts: blocks of the bank with which linear velocity and turn rate begin.
        count: N, how many samples: block after block, of the last one as many as are left.

    Returns:
        (N,) float64.
    """
    return np.asarray(_costs(_single(world), targets.astype(_F), noise, *firsts, count))


def _single(world: World) -> World:
    """The same in single precision, as far as it is not yet."""
    start, bounds, route, field, moving, prices, step_s = world
    narrow: Callable[[float], Any] = np.float32
    return World(
        Start(*map(narrow, start)),
        Bounds(*map(narrow, bounds)),
        Route(route.samples.astype(_F, copy=False), narrow(route.spacing)),
        Field(field.room, *map(narrow, field[1:])),
        moving.astype(_F, copy=False),
        Prices(*map(narrow, prices)),
        narrow(step_s),
    )


@njit(cache=True, fastmath=True, error_model="numpy")
def _costs(world, targets, noise, first_v, first_w, count):  # type: ignore[no-untyped-def]  # numba kernel
    """See ``costs_of``; everything in single precision but the sums."""
    total = np.zeros(count)
    state, found = np.empty((16, BLOCK + _APART), _F), np.empty((6, BLOCK + _APART), _F)
    at = np.empty(BLOCK, np.int32)
    for first in range(0, count, BLOCK):
        size, number = min(BLOCK, count - first), first // BLOCK
        asked_v, asked_w = noise[0, first_v + number], noise[1, first_w + number]
        cost = _roll(world, targets, asked_v, asked_w, state, found, at)
        total[first : first + size] = world.step_s * cost[:size]
    return total


@njit(cache=True, fastmath=True, error_model="numpy")
def _roll(world, targets, asked_v, asked_w, state, found, at):  # type: ignore[no-untyped-def]  # numba kernel
    """(BLOCK,) prices per second of a block of samples, summed over the steps; the last three are scratch."""
    start, bounds, route, field, moving, prices, step_s = world
    x, y, c, s, v, a, w, b = state[0], state[1], state[2], state[3], state[4], state[5], state[6], state[7]
    way, turn, cost, room = state[8], state[9], state[10], state[11]
    arc, lateral, facing, wanted = state[12], state[13], state[14], state[15]
    x[:], y[:], arc[:], cost[:] = start.x, start.y, start.along, _NONE
    c[:], s[:] = np.cos(start.yaw), np.sin(start.yaw)
    v[:], a[:] = start.linear, start.linear_gain
    w[:], b[:] = start.angular, start.angular_gain
    for k in range(targets.shape[1]):
        _accelerate(
            v, a, way, targets[0, k], asked_v[k], step_s,
            bounds.lowest, bounds.highest, bounds.acceleration, bounds.jerk,
        )  # fmt: skip
        _accelerate(
            w, b, turn, targets[1, k], asked_w[k], step_s,
            -bounds.turn_rate, bounds.turn_rate, bounds.turn_acceleration, bounds.turn_jerk,
        )  # fmt: skip
        _move(x, y, c, s, way, turn)
        _place(arc, lateral, facing, wanted, x, y, c, s, way, route.samples, route.spacing, at, found)
        _look_up(room, x, y, field.room, field.x0, field.y0, field.resolution, at, found)
        _charge(cost, v, a, b, lateral, facing, wanted, room, prices, bounds.highest)
        for m in range(moving.shape[1]):
            _charge_moving(cost, x, y, v, moving[k, m], prices, bounds.highest)
    return cost


@njit(cache=True, fastmath=True, error_model="numpy")
def _accelerate(v, a, way, target, asked, step_s, lowest, highest, acceleration, jerk):  # type: ignore[no-untyped-def]  # numba kernel
    """One step of one velocity; ``way`` is how far it leads.

    This is ``next_velocity`` for a target that rests: then the range of velocities may cut the target, which
    saves two roots in three.
    """
    for n in range(BLOCK):
        aim = min(max(target + asked[n], lowest), highest)
        gain = within(approach(aim - v[n], step_s, jerk), a[n], step_s, acceleration, jerk)
        after = v[n] + gain * step_s
        way[n] = _HALF * (v[n] + after) * step_s
        v[n], a[n] = after, gain


@njit(cache=True, fastmath=True, error_model="numpy")
def _move(x, y, c, s, way, turn):  # type: ignore[no-untyped-def]  # numba kernel
    """Along the chord of the arc; c, s are cosine and sine of the heading, by their series."""
    for n in range(BLOCK):
        half = _HALF * turn[n]
        square = half * half
        ch = _ALL - square * (_HALF - square * _24TH)
        sh = half * (_ALL - square * (_SIXTH - square * _120TH))
        middle_c, middle_s = c[n] * ch - s[n] * sh, s[n] * ch + c[n] * sh
        x[n] += way[n] * middle_c
        y[n] += way[n] * middle_s
        c[n], s[n] = middle_c * ch - middle_s * sh, middle_s * ch + middle_c * sh


@njit(cache=True, fastmath=True, error_model="numpy")
def _place(arc, lateral, facing, wanted, x, y, c, s, way, route, spacing, at, found):  # type: ignore[no-untyped-def]  # numba kernel
    """Projects on the leg by one Newton step from where the last place and the way driven point to.

    First which samples, then what they hold, then sums: a loop that looks things up is not vectorised, and
    one that writes three arrays not either.
    """
    last = _F(route.shape[0] - 1)
    px, py, tx, ty, bend = found[0], found[1], found[2], found[3], found[4]
    for n in range(BLOCK):
        at[n] = np.int32(min(max((arc[n] + way[n]) / spacing, _NONE), last))
    for n in range(BLOCK):
        i = np.uintp(at[n])
        px[n], py[n], tx[n], ty[n] = route[i, 0], route[i, 1], route[i, 2], route[i, 3]
        bend[n], wanted[n] = route[i, 4], route[i, 6]
    for n in range(BLOCK):
        lateral[n] = (y[n] - py[n]) * tx[n] - (x[n] - px[n]) * ty[n]
    for n in range(BLOCK):
        facing[n] = c[n] * tx[n] + s[n] * ty[n]
    for n in range(BLOCK):
        ahead = (x[n] - px[n]) * tx[n] + (y[n] - py[n]) * ty[n]
        arc[n] = _F(at[n]) * spacing + ahead / max(_ALL - bend[n] * lateral[n], _LEAST_SHRINK)


@njit(cache=True, fastmath=True, error_model="numpy")
def _look_up(room, x, y, field, x0, y0, resolution, at, found):  # type: ignore[no-untyped-def]  # numba kernel
    """Bilinear; which cells, what they hold, then the sums."""
    width, cells = np.int32(field.shape[1]), field.reshape(-1)
    top, right = _F(field.shape[0] - 1.001), _F(field.shape[1] - 1.001)
    u, v, one, two, three, four = found[0], found[1], found[2], found[3], found[4], found[5]
    for n in range(BLOCK):
        fx = min(max((x[n] - x0) / resolution, _NONE), right)
        fy = min(max((y[n] - y0) / resolution, _NONE), top)
        i, j = np.int32(fy), np.int32(fx)
        u[n], v[n] = fx - _F(j), fy - _F(i)
        at[n] = i * width + j
    for n in range(BLOCK):
        k = np.uintp(at[n])
        above = k + np.uintp(width)
        one[n], two[n] = cells[k], cells[k + np.uintp(1)]
        three[n], four[n] = cells[above], cells[above + np.uintp(1)]
    for n in range(BLOCK):
        low = one[n] + u[n] * (two[n] - one[n])
        high = three[n] + u[n] * (four[n] - three[n])
        room[n] = low + v[n] * (high - low)


@njit(cache=True, fastmath=True, error_model="numpy")
def _charge(cost, v, a, b, lateral, facing, wanted, room, prices, highest):  # type: ignore[no-untyped-def]  # numba kernel
    """Everything but what moves."""
    lag_price, band = prices.speed / highest, prices.soft - prices.hard
    for n in range(BLOCK):
        lag = wanted[n] - v[n] * facing[n]
        off, square = abs(lateral[n]), lateral[n] * lateral[n]
        tight = min(max((prices.soft - room[n]) / band, _NONE), _ALL) * v[n] / highest
        short = prices.hard - room[n]
        cost[n] += (
            lag_price * lag * lag / (wanted[n] + _SLOW_MPS)
            + prices.deviation * square / (square + _DEVIATION_M * _DEVIATION_M)
            + prices.offset * off
            + prices.beyond * max(off - prices.widest, _NONE)
            + prices.heading * (_ALL - facing[n])
            + prices.acceleration * a[n] * a[n]
            + prices.turn_acceleration * b[n] * b[n]
            + prices.reverse * max(-v[n], _NONE)
            + prices.room * tight * tight
            + (prices.touch + prices.depth * short if short > _NONE else _NONE)
        )


@njit(cache=True, fastmath=True, error_model="numpy")
def _charge_moving(cost, x, y, v, disc, prices, highest):  # type: ignore[no-untyped-def]  # numba kernel
    """Being touched at rest is not the robot's doing, so haste counts."""
    for n in range(BLOCK):
        dx, dy = x[n] - disc[0], y[n] - disc[1]
        spare = np.sqrt(dx * dx + dy * dy) - disc[2]
        close = min(max(_ALL - spare / disc[3], _NONE), _ALL)
        touch = prices.touch - prices.depth * spare if spare < _NONE else _NONE
        cost[n] += prices.near * close * close + touch * (_AT_REST + abs(v[n]) / highest)
