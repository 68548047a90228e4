"""Which command is in force, and the way to it."""

from __future__ import annotations

import math
import threading
from dataclasses import dataclass

from explore_bt.types import MotionLimits, Twist2
from explore_bt_drivers.orders.axis import Ramp

__all__ = ["Order", "Orders"]

_WATCHDOG_S = 0.5
_USUAL_PERIOD_S = 0.05
_LONGEST_PERIOD_S = 0.2


@dataclass(frozen=True, slots=True)
class Order:
    """The command in force: set-points of both axes, their slopes, and the step it came at."""

    twist: Twist2
    linear: Ramp
    angular: Ramp
    slopes: tuple[float, float]
    step: int


_STILL: Ramp = (0.0, 0.0, 0, 0, 0.0)
_HALT = Order(Twist2(), _STILL, _STILL, (0.0, 0.0), 0)


class Orders:
    """The command in force, in steps of a body's own.

    A twist that is within the limits as seen from the commands before it is reached along a straight
    ramp over one command period, since another is likely to follow; any other is reached as fast as the
    limits allow, without passing it. Half a second after the last command the body halts.

    ``halt`` may be called from any thread, everything else belongs to one.
    """

    def __init__(self, limits: MotionLimits, step_s: float) -> None:
        self._limits = limits
        self._step_s = step_s
        self._watchdog_steps = round(_WATCHDOG_S / step_s)
        self._usual_steps = round(_USUAL_PERIOD_S / step_s)
        self._longest_steps = round(_LONGEST_PERIOD_S / step_s)
        self._order = _HALT
        self._lock = threading.Lock()

    def command(self, twist: Twist2, step: int, now: tuple[float, float, float, float]) -> None:
        """Go for a twist from a step on.

        Args:
            twist: as asked for; cut to the limits.
            step: the body's newest one.
            now: velocity and acceleration of both axes then: m/s, m/s², rad/s, rad/s².
        """
        limits = self._limits
        wanted = Twist2(
            min(max(twist.linear_mps, -limits.speed_mps), limits.speed_mps),
            min(max(twist.angular_rps, -limits.turn_rate_rps), limits.turn_rate_rps),
        )
        with self._lock:
            last = self._order
            if last is _HALT:
                v, acceleration, w, turn_acceleration = now
                before, slopes, steps = Twist2(v, w), (acceleration, turn_acceleration), self._usual_steps
            else:
                before, slopes = last.twist, last.slopes
                steps = min(max(step - last.step, 1), self._longest_steps)
            linear, slope = self._ramp(
                before.linear_mps,
                wanted.linear_mps,
                slopes[0],
                (step, steps),
                (limits.acceleration_mps2, limits.jerk_mps3),
            )
            angular, turn_slope = self._ramp(
                before.angular_rps,
                wanted.angular_rps,
                slopes[1],
                (step, steps),
                (limits.turn_acceleration_rps2, limits.turn_jerk_rps3),
            )
            self._order = Order(wanted, linear, angular, (slope, turn_slope), step)

    def halt(self) -> None:
        """Brake as the limits allow and stand until the next command."""
        with self._lock:
            self._order = _HALT

    def at(self, step: int) -> Order:
        """What is in force at a step, which must not go back; the watchdog is heard."""
        order = self._order
        if order is not _HALT and step >= order.step + self._watchdog_steps:
            self.halt()
            return _HALT
        return order

    def until(self, order: Order, last_step: int) -> int:
        """The step up to which an order surely holds unless another comes, at most ``last_step``."""
        return last_step if order is _HALT else min(last_step, order.step + self._watchdog_steps)

    def _ramp(
        self,
        begin: float,
        end: float,
        slope_before: float,
        when: tuple[int, int],
        limits: tuple[float, float],
    ) -> tuple[Ramp, float]:
        """The set-point's way to a new command, and its slope; a jump where the limits forbid a ramp."""
        step, steps = when
        acceleration, jerk = limits
        period_s = steps * self._step_s
        slope = (end - begin) / period_s
        change = abs(slope - slope_before)
        if abs(slope) <= 1.01 * acceleration and change <= 1.05 * jerk * period_s + 1e-9:
            # under the same jerk the slope can die away over this much more velocity, counted from its end
            dying = max(abs(slope) - 0.5 * jerk * period_s, 0.0)
            rest = end + math.copysign(0.5 * dying * dying / jerk, slope)
            return (begin, end, step, steps, rest), slope
        return (end, end, step, 0, end), slope
