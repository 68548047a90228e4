"""A fallen robot is stood up by somebody."""

from __future__ import annotations

import mujoco
import numpy as np
from numpy.typing import NDArray

from explore_bt_drivers.mujoco.figures import WHEEL_RADIUS_M
from explore_bt_drivers.mujoco.track import STEP_S

__all__ = ["Lift"]

_LIFT_S = 2.0


class Lift:
    """Turns a body upright about its axle, which goes to where there is room for it.

    Args:
        row: the body's state, as in a ``Track``.
        end: (7,) float64, position and quaternion (w x y z) of ``base_link`` that it is put to.
    """

    def __init__(self, row: NDArray[np.float64], end: NDArray[np.float64]) -> None:
        self._quaternion, self._end = row[3:7].copy(), end[3:]
        self._axle = row[:3] + WHEEL_RADIUS_M * _up(self._quaternion)
        self._axle_end = end[:3] + WHEEL_RADIUS_M * _up(end[3:])
        self._steps, self._step = round(_LIFT_S / STEP_S), 0
        self._before = self._place(0.0)

    @property
    def is_over(self) -> bool:
        """Whether it stands."""
        return self._step >= self._steps

    def next(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Position and quaternion (7,), velocities (6,) as MuJoCo has them, after one more step."""
        self._step += 1
        share = self._step / self._steps
        now = self._place(share * share * (3.0 - 2.0 * share))  # gently off, gently down
        velocity = np.zeros(6)
        if not self.is_over:
            velocity[:3] = (now[:3] - self._before[:3]) / STEP_S
            mujoco.mju_subQuat(velocity[3:], now[3:], self._before[3:])
            velocity[3:] /= STEP_S
        self._before = now
        return now, velocity

    def _place(self, share: float) -> NDArray[np.float64]:
        turn = np.empty(3)
        mujoco.mju_subQuat(turn, self._end, self._quaternion)
        quaternion = self._quaternion.copy()
        mujoco.mju_quatIntegrate(quaternion, turn, share)
        axle = self._axle + share * (self._axle_end - self._axle)
        return np.concatenate((axle - WHEEL_RADIUS_M * _up(quaternion), quaternion))


def _up(quaternion: NDArray[np.float64]) -> NDArray[np.float64]:
    up = np.empty(3)
    mujoco.mju_rotVecQuat(up, np.array([0.0, 0.0, 1.0]), quaternion)
    return up
