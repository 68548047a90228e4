"""One robot's body in a world: commands in, a track of states out."""

from __future__ import annotations

import math
import threading
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from explore_bt.types import MotionLimits, Pose2, Twist2, wrap_angle
from explore_bt_drivers.sim2d.motion import ACC, ON_STEP, STEP_S, V, X, Y, advance, states_at
from explore_bt_drivers.world import World

__all__ = ["Body", "Ramp", "Track"]

_WATCHDOG_STEPS = round(0.5 / STEP_S)
_USUAL_PERIOD_STEPS = round(0.05 / STEP_S)
_LONGEST_PERIOD_STEPS = round(0.2 / STEP_S)
_ROOM_STEPS = 4096
_MEMORY_STEPS = 512
"""States that stay when the track is moved up: more than the longest sweep (2 s) needs."""

Ramp = tuple[float, float, int, int, float]
"""A set-point: begin, end, first internal step, number of steps, and where it may come to rest."""


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


@dataclass(frozen=True, slots=True)
class _Order:
    """The command in force: set-points of both axes, their slopes, and the step it came at."""

    twist: Twist2
    linear: Ramp
    angular: Ramp
    slopes: tuple[float, float]
    step: int


_STILL: Ramp = (0.0, 0.0, 0, 0, 0.0)
_HALT = _Order(Twist2(), _STILL, _STILL, (0.0, 0.0), 0)


class Body:
    """A unicycle under limits of speed, acceleration and jerk, with a circular footprint.

    A twist that is within the limits as seen from the commands before it is reached along a straight
    ramp over one command period, since another is likely to follow; any other is reached as fast as the
    limits allow, without passing it. Half a second after the last command the body halts.

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
        self._limits = limits
        self._limit_values = (
            limits.speed_mps,
            limits.acceleration_mps2,
            limits.jerk_mps3,
            limits.turn_rate_rps,
            limits.turn_acceleration_rps2,
            limits.turn_jerk_rps3,
        )
        self._touching = False
        self._order = _HALT
        self._lock = threading.Lock()

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

    @property
    def speed_limit_mps(self) -> float:
        """It is never faster."""
        return self._limits.speed_mps

    def command(self, twist: Twist2) -> None:
        """Go for a twist from the next internal step on."""
        limits = self._limits
        wanted = Twist2(
            min(max(twist.linear_mps, -limits.speed_mps), limits.speed_mps),
            min(max(twist.angular_rps, -limits.turn_rate_rps), limits.turn_rate_rps),
        )
        step = self.track.last_step
        with self._lock:
            last = self._order
            if last is _HALT:
                _, _, _, v, acceleration, w, turn_acceleration = self.track.now.tolist()
                before, slopes, steps = Twist2(v, w), (acceleration, turn_acceleration), _USUAL_PERIOD_STEPS
            else:
                before, slopes = last.twist, last.slopes
                steps = min(max(step - last.step, 1), _LONGEST_PERIOD_STEPS)
            linear, slope = _ramp(
                before.linear_mps,
                wanted.linear_mps,
                slopes[0],
                (step, steps),
                (limits.acceleration_mps2, limits.jerk_mps3),
            )
            angular, turn_slope = _ramp(
                before.angular_rps,
                wanted.angular_rps,
                slopes[1],
                (step, steps),
                (limits.turn_acceleration_rps2, limits.turn_jerk_rps3),
            )
            self._order = _Order(wanted, linear, angular, (slope, turn_slope), step)

    def halt(self) -> None:
        """Brake as the limits allow and stand until the next command."""
        with self._lock:
            self._order = _HALT

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
            order, step = self._order, self.track.last_step
            alarm = order.step + _WATCHDOG_STEPS
            if order is not _HALT and step >= alarm:
                self.halt()
                continue
            until = last_step if order is _HALT else min(last_step, alarm)
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


def _ramp(
    begin: float, end: float, slope_before: float, when: tuple[int, int], limits: tuple[float, float]
) -> tuple[Ramp, float]:
    """The set-point's way to a new command, and its slope; a jump where the limits forbid a ramp."""
    step, steps = when
    acceleration, jerk = limits
    period_s = steps * STEP_S
    slope = (end - begin) / period_s
    change = abs(slope - slope_before)
    if abs(slope) <= 1.01 * acceleration and change <= 1.05 * jerk * period_s + 1e-9:
        # under the same jerk the slope can die away over this much more velocity, counted from its end
        dying = max(abs(slope) - 0.5 * jerk * period_s, 0.0)
        rest = end + math.copysign(0.5 * dying * dying / jerk, slope)
        return (begin, end, step, steps, rest), slope
    return (end, end, step, 0, end), slope
