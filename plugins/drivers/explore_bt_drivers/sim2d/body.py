"""One robot's body in a world: commands in, a track of states out."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from explore_bt.types import MotionLimits, Pose2, Twist2, wrap_angle
from explore_bt_drivers.orders import Orders
from explore_bt_drivers.sim2d.motion import ACC, ON_STEP, STEP_S, V, X, Y, advance, states_at
from explore_bt_drivers.world import World

__all__ = ["Body", "Track"]

_ROOM_STEPS = 4096
_MEMORY_STEPS = 512
"""States that stay when the track is moved up: more than the longest sweep (2 s) needs."""


class Track:
    """The newest states of a body, one per internal step, from ``step`` on.

    Attributes:
        last_step: the newest one; its time is ``last_step * STEP_S``.
    """

    def __init__(self, start: Pose2, step: int = 0) -> None:
        self._rows = np.zeros((_ROOM_STEPS, 7))
        self._rows[0, :3] = start.as_array()
        self.first_step = self.last_step = step

    @property
    def states(self) -> NDArray[np.float64]:
        """(K, 7) float64 view: states ``first_step`` to ``last_step``, columns as in ``motion``."""
        return self._rows[: self.last_step - self.first_step + 1]

    @property
    def now(self) -> NDArray[np.float64]:
        """(7,) float64 view: the newest state."""
        return self._rows[self.last_step - self.first_step]

    def room(self, steps: int) -> tuple[NDArray[np.float64], int, int]:
        """All rows, the row of the newest state, and how many of ``steps`` fit behind it (>= 1)."""
        if self.last_step - self.first_step + 1 >= _ROOM_STEPS:
            self._rows[:_MEMORY_STEPS] = self._rows[-_MEMORY_STEPS:]
            self.first_step = self.last_step - _MEMORY_STEPS + 1
        row = self.last_step - self.first_step
        return self._rows, row, min(steps, _ROOM_STEPS - 1 - row)

    def due(self, rate_hz: float) -> int:
        """How many samples of a sensor are due by the newest state; the first comes after one period."""
        return math.floor((self.last_step + ON_STEP) * STEP_S * rate_hz)

    def at(self, times_s: NDArray[np.float64]) -> NDArray[np.float64]:
        """(N, 7) float64 states at (N,) times, which the track must still hold."""
        out = np.empty((len(times_s), 7))
        states_at(self.states, self.first_step, times_s, out)
        return out


class Body:
    """A unicycle under limits of speed, acceleration and jerk, with a circular footprint.

    See ``Orders`` for how commands become set-points.

    ``command`` and ``advance`` belong to one thread; ``halt`` may be called from any.

    Attributes:
        track: where it has been.
        world: what it runs into; may be exchanged for another version between two calls.
        contacts: how many separate times it has, other robots included.
        radius_m: of the footprint.
        has_stepped_back: whether the last internal step was taken back.
    """

    def __init__(
        self, world: World, start: Pose2, radius_m: float, limits: MotionLimits, step: int = 0
    ) -> None:
        self.track = Track(start, step)
        self.contacts = 0
        self.world = world
        self.radius_m = radius_m
        self.has_stepped_back = False
        self.speed_limit_mps = limits.speed_mps
        self._orders = Orders(limits, STEP_S)
        self._limit_values = (
            limits.speed_mps,
            limits.acceleration_mps2,
            limits.jerk_mps3,
            limits.turn_rate_rps,
            limits.turn_acceleration_rps2,
            limits.turn_jerk_rps3,
        )
        self._touching = False

    @property
    def pose(self) -> Pose2:
        """Where it is now, ``map`` frame."""
        x, y, yaw = (float(value) for value in self.track.now[:3])
        return Pose2(x, y, wrap_angle(yaw))

    @property
    def xy(self) -> tuple[float, float]:
        """Where its centre is now, metres, ``map`` frame."""
        x, y = self.track.now[:2].tolist()
        return (x, y)

    def command(self, twist: Twist2) -> None:
        """Go for a twist from the next internal step on."""
        _, _, _, v, acceleration, w, turn_acceleration = self.track.now.tolist()
        self._orders.command(twist, self.track.last_step, (v, acceleration, w, turn_acceleration))

    def halt(self) -> None:
        """Brake as the limits allow and stand until the next command."""
        self._orders.halt()

    def step_back(self) -> None:
        """Something stands in the way: the newest internal step is not made, but for its turn."""
        if self.has_stepped_back:
            return
        self.has_stepped_back = True
        before, now = self.track.states[-2], self.track.now
        now[[X, Y]] = before[[X, Y]]
        now[[V, ACC]] = 0.0

    def advance(self, last_step: int) -> None:
        """Move on to an internal step."""
        while self.track.last_step < last_step:
            step = self.track.last_step
            order = self._orders.at(step)
            until = self._orders.until(order, last_step)
            states, row, count = self.track.room(until - step)
            self._touching, touches = advance(
                self.world.index,
                states,
                row,
                count,
                step,
                order.linear,
                order.angular,
                self._limit_values,
                self.radius_m,
                self._touching,
            )
            self.contacts += touches
            self.track.last_step += count
