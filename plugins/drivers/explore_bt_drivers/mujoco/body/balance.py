"""Keeps the robot upright at the speed it was told: a linear-quadratic regulator, and turns apart."""

from __future__ import annotations

import numpy as np
from scipy.linalg import solve_discrete_are

from explore_bt_drivers.mujoco.body.build import TORQUE_NM
from explore_bt_drivers.mujoco.body.foresight import Wish
from explore_bt_drivers.mujoco.body.plant import Plant

__all__ = ["CONTROL_S", "Balance", "Felt"]

CONTROL_S = 0.004
"""Period of the control."""

Felt = tuple[float, float, float, float]
"""What the body feels: speed of the axle (m/s), pitch (rad), pitch rate and turn rate (rad/s)."""

_WEIGHTS = np.diag([100.0, 60.0, 200.0, 20.0])
"""Of way, speed, pitch, pitch rate. With 2 for the last it fell at a push of 30 N·s, with 10 for the first it
ran 2 cm past its stops."""
_TORQUE_WEIGHT = 0.05
_FARTHEST_M = 0.15
"""So far behind its wish the robot hurries: held longer (by a wall, by a hand), it forgets the rest."""
_TURN_RATE_GAIN, _TURN_GAIN = 25.0, 60.0
"""1/s and 1/s² of the angular acceleration asked for."""
_FARTHEST_RAD = 0.1
_GRIP_MPS2 = 10.0
"""No tyre makes the robot faster than that; wheels that say so spin."""
_SPIN_MPS, _GRIPPING_NM = 0.1, 2.0
"""Wheels that are so much faster than the robot can be get this torque at most, until they hold again."""


class Balance:
    """Torques of the wheels from what the body feels; remembers how far it is behind its wish."""

    def __init__(self, plant: Plant) -> None:
        self._plant = plant
        state, torque = plant.linear(CONTROL_S)
        cost = solve_discrete_are(state, torque, _WEIGHTS, np.array([[_TORQUE_WEIGHT]]))
        gain = np.linalg.solve(_TORQUE_WEIGHT + torque.T @ cost @ torque, torque.T @ cost @ state)
        self._gain: tuple[float, ...] = tuple(gain[0].tolist())
        self._turn_torque = 2.0 * plant.yaw_kgm2 * plant.wheel_m / plant.track_m
        self.forget()

    def forget(self) -> None:
        """Begin anew, from wherever the body is."""
        self._behind_m = self._unturned_rad = self._speed_mps = 0.0

    def torques(self, felt: Felt, wish: Wish) -> tuple[float, float]:
        """Torques of the left and the right motor, N·m, for the coming period."""
        rolled, pitch, pitch_rate, turn_rate = felt
        self._speed_mps += _cut(rolled - self._speed_mps, _GRIP_MPS2 * CONTROL_S)
        speed = self._speed_mps
        limit = TORQUE_NM if abs(rolled - speed) < _SPIN_MPS else _GRIPPING_NM
        behind, turned = wish.speed_mps - speed, wish.turn_rps - turn_rate
        self._behind_m = _cut(self._behind_m + behind * CONTROL_S, _FARTHEST_M)
        self._unturned_rad = _cut(self._unturned_rad + turned * CONTROL_S, _FARTHEST_RAD)
        by_way, by_speed, by_pitch, by_rate = self._gain
        both = wish.torque_nm + by_way * self._behind_m + by_speed * behind
        both += by_pitch * (wish.pitch_rad - (pitch - self._plant.lean_rad))
        both += by_rate * (wish.pitch_rate_rps - pitch_rate)
        turning = wish.turn_slope_rps2 + _TURN_RATE_GAIN * turned + _TURN_GAIN * self._unturned_rad
        # balance comes first: what the motors have left is for turning
        half = _cut(0.5 * both, limit)
        aside = _cut(0.5 * self._turn_torque * turning, max(limit - abs(half), 0.2 * limit))
        return half - aside, half + aside


def _cut(value: float, limit: float) -> float:
    return min(max(value, -limit), limit)
