"""A mission starts at rest: what the gyroscope says until the robot first moves is its bias."""

from __future__ import annotations

from collections import deque

import numpy as np

from explore_bt.types import Imu

__all__ = ["Standstill"]

_DELAY_S = 0.3
_BIAS_RPS = 0.03
_TURN_RPS = 0.015
_PUSH_MPS2 = 0.2


class Standstill:
    """Hands out samples once the robot has stood still for another 0.3 s; ends for good when it moves.

    The delay keeps the first, slow part of a motion out, which no threshold tells from noise.
    """

    def __init__(self) -> None:
        self._waiting: deque[tuple[float, float]] = deque()
        self._sum = np.zeros(3)
        self._count = 0
        self._is_over = False

    def end(self) -> None:
        """The robot has moved before."""
        self._is_over = True

    def rates_rps(self, imu: Imu) -> list[float]:
        """Yaw rates that were measured at rest, each handed out once; rad/s, ``base_link``."""
        if self._is_over:
            return []
        sample = np.array([imu.angular_velocity_rps[2], *imu.linear_acceleration_mps2[:2]])
        off = np.abs(sample - self._sum / self._count) if self._count else np.zeros(3)
        if abs(sample[0]) > _BIAS_RPS or off[0] > _TURN_RPS or off[1:].max() > _PUSH_MPS2:
            self._is_over = True
            return []
        self._sum += sample
        self._count += 1
        self._waiting.append((imu.stamp_s, float(sample[0])))
        settled = []
        while self._waiting[0][0] <= imu.stamp_s - _DELAY_S:
            settled.append(self._waiting.popleft()[1])
        return settled
