"""Limits of motion, and the state of motion they bound."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol, Self

from explore_bt.types.pose import Twist2

__all__ = ["MotionLimits", "MotionState"]


class _Figures(Protocol):
    """The limits as a driver's options name them, in the same units."""

    speed: float
    acceleration: float
    jerk: float
    turn_rate: float
    turn_acceleration: float
    turn_jerk: float


@dataclass(frozen=True, slots=True)
class MotionLimits:
    """Largest magnitudes of a unicycle's velocity, acceleration and jerk, linear and angular."""

    speed_mps: float = 0.5
    acceleration_mps2: float = 0.5
    jerk_mps3: float = 2.0
    turn_rate_rps: float = 1.2
    turn_acceleration_rps2: float = 2.0
    turn_jerk_rps3: float = 8.0

    @classmethod
    def of(cls, options: _Figures) -> Self:
        """The limits that a driver's options name."""
        return cls(
            options.speed,
            options.acceleration,
            options.jerk,
            options.turn_rate,
            options.turn_acceleration,
            options.turn_jerk,
        )


@dataclass(frozen=True, slots=True)
class MotionState:
    """The command that was last sent, and how fast it was changing.

    The next command starts from here, whoever sent the last one: the controller or the brake.
    """

    twist: Twist2 = Twist2()
    linear_acceleration_mps2: float = 0.0
    angular_acceleration_rps2: float = 0.0
