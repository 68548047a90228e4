"""Gyroscope and accelerometer at the base's centre."""

from __future__ import annotations

import numpy as np

from explore_bt.types import Imu
from explore_bt_drivers.sim2d.body import Track
from explore_bt_drivers.sim2d.motion import ACC, V, W
from explore_bt_drivers.sim2d.options import Sim2dOptions

__all__ = ["InertialUnit"]

_GRAVITY_MPS2 = 9.81


class InertialUnit:
    """Turn rate about z, acceleration along x (speeding up) and y (cornering), gravity along z."""

    def __init__(self, options: Sim2dOptions, rng: np.random.Generator) -> None:
        self._rate_hz = options.imu_rate
        self._rng = rng
        gyro, accel = options.gyro_noise, options.accel_noise
        self._sigma = np.array([gyro, gyro, gyro, accel, accel, accel]) if options.noise else np.zeros(6)
        self._bias = np.zeros(6)
        if options.noise:
            self._bias[:3] = rng.normal(0.0, options.gyro_bias, 3)
        self._samples = 0

    @property
    def gyro_bias_rps(self) -> float:
        """The constant error of the turn rate about z, drawn per seed."""
        return float(self._bias[2])

    def begin(self, track: Track) -> None:
        """Measure from here on: a resumed run begins in the middle."""
        self._samples = track.due(self._rate_hz)

    def measure(self, track: Track) -> list[Imu]:
        """The samples taken since the last call."""
        due = track.due(self._rate_hz)
        if due == self._samples:
            return []
        stamps = np.arange(self._samples + 1, due + 1) / self._rate_hz
        self._samples = due
        states = track.at(stamps)
        values = self._bias + self._sigma * self._rng.standard_normal((len(stamps), 6))
        values[:, 2] += states[:, W]
        values[:, 3] += states[:, ACC]
        values[:, 4] += states[:, V] * states[:, W]
        values[:, 5] += _GRAVITY_MPS2
        return [
            Imu(stamp, (row[0], row[1], row[2]), (row[3], row[4], row[5]))
            for stamp, row in zip(stamps.tolist(), values.tolist(), strict=True)
        ]
