"""What is asked of the next control period."""

from __future__ import annotations

from dataclasses import dataclass, replace

from explore_bt.interfaces import ControlStatus
from explore_bt.types import MotionLimits, MotionState
from explore_bt_controllers.limiter import next_velocity

__all__ = ["Wish", "at_rest", "next_linear", "next_turn_rate", "stuck"]


@dataclass(frozen=True, slots=True)
class Wish:
    """What the path asks for at the end of the next period.

    Attributes:
        linear_mps: within the limits already.
        angular_rps: wanted turn rate, yet to be limited.
        angular_rps2: how fast that rate changes.
        status: ``running``, ``arrived`` or ``stuck``.
        reason: in words, why it is stuck.
    """

    linear_mps: float
    angular_rps: float
    angular_rps2: float = 0.0
    status: ControlStatus = ControlStatus.RUNNING
    reason: str = ""


def at_rest(motion: MotionState, limits: MotionLimits, dt_s: float) -> Wish:
    """The way to a standstill, and staying there."""
    return Wish(next_linear(0.0, motion, limits, dt_s), 0.0)


def stuck(wish: Wish, reason: str) -> Wish:
    """The same motion, given up for a reason."""
    return replace(wish, status=ControlStatus.STUCK, reason=reason)


def next_linear(target_mps: float, motion: MotionState, limits: MotionLimits, dt_s: float) -> float:
    """The linear velocity (m/s) to command for the next period on the way to a target, under the limits."""
    return float(
        next_velocity(
            motion.twist.linear_mps,
            motion.linear_acceleration_mps2,
            target_mps,
            0.0,
            dt_s,
            -limits.speed_mps,
            limits.speed_mps,
            limits.acceleration_mps2,
            limits.jerk_mps3,
        )
    )


def next_turn_rate(wish: Wish, motion: MotionState, limits: MotionLimits, dt_s: float) -> float:
    """The turn rate (rad/s) to command for the next period on the way to the wanted one, under the limits."""
    return float(
        next_velocity(
            motion.twist.angular_rps,
            motion.angular_acceleration_rps2,
            wish.angular_rps,
            wish.angular_rps2,
            dt_s,
            -limits.turn_rate_rps,
            limits.turn_rate_rps,
            limits.turn_acceleration_rps2,
            limits.turn_jerk_rps3,
        )
    )
