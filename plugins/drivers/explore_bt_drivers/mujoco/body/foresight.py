"""What the balance does before the speed changes: it leans.

A balancing robot cannot speed up before it leans, and to lean it must first roll back a little. Told of a
change only when it is due, it rolls back, comes late, and runs past the place where it is to stand. So
set-points are acted on a little later than they come, and until then it is known what is ahead.

With x'' = a given, the pitch that carries it obeys θ'' = ω² (θ - c a): unstable forwards in time. Its one
bounded solution looks both ways (stable inversion, Devasia, Chen and Paden 1996)::

    θ(t) = c ω / 2 · ( ∫ past e^(-ω (t-s)) a(s) ds + ∫ future e^(-ω (s-t)) a(s) ds )

The future is cut off at the foresight; beyond it the acceleration is taken to stay.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from explore_bt_drivers.mujoco.body.plant import Plant
from explore_bt_drivers.mujoco.figures import FORESIGHT_S

__all__ = ["Foresight", "Wish"]


class Wish(NamedTuple):
    """What is wanted of the body now; the pitch counts from the lean, the torque is that of both motors."""

    speed_mps: float = 0.0
    slope_mps2: float = 0.0
    turn_rps: float = 0.0
    turn_slope_rps2: float = 0.0
    pitch_rad: float = 0.0
    pitch_rate_rps: float = 0.0
    torque_nm: float = 0.0


class Foresight:
    """Set-points in, one a period; what to do about the one that is due out."""

    def __init__(self, plant: Plant, period_s: float) -> None:
        moment = plant.body_kg * plant.above_m
        by_lean = moment * plant.gravity_mps2
        self._plant = plant
        self._moment = moment
        self._rate = math.sqrt(by_lean / (plant.body_kgm2 + moment * (plant.above_m + plant.wheel_m)))
        self._pitch = (moment + plant.wheel_m * plant.rolling_kg) / by_lean
        self._share = self._rate * period_s
        self._ahead = round(FORESIGHT_S / period_s)
        self._weights = self._share * np.exp(-self._share * np.arange(self._ahead + 1))
        self._beyond = math.exp(-self._share * (self._ahead + 1))
        self.forget()

    def forget(self) -> None:
        """As if the robot had stood still for ever."""
        self._rows = np.zeros((2 * (self._ahead + 1), 4))  # each row twice, so that a window is in one piece
        self._next = 0
        self._past = 0.0

    def wish(self, latest: Sequence[float]) -> Wish:
        """Take the latest set-point: speed, its slope, turn rate, its slope."""
        size = self._ahead + 1
        self._rows[self._next] = self._rows[self._next + size] = latest
        self._next = (self._next + 1) % size
        window = self._rows[self._next : self._next + size]
        speed, slope, turn, turn_slope = window[0].tolist()
        self._past += (slope - self._past) * self._share
        future = float(self._weights @ window[:, 1]) + self._beyond * latest[1]
        pitch = 0.5 * self._pitch * (self._past + future)
        pitch_rate = 0.5 * self._pitch * self._rate * (future - self._past)
        bending = self._rate**2 * (pitch - self._pitch * slope)
        torque = self._plant.wheel_m * (self._plant.rolling_kg * slope + self._moment * bending)
        return Wish(speed, slope, turn, turn_slope, pitch, pitch_rate, torque)
