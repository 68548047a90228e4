"""Gyroscope and accelerometer in the axle's middle; noise and bias are added here, MuJoCo adds none."""

from __future__ import annotations

import numpy as np

from explore_bt.types import Imu
from explore_bt_drivers.mujoco.options import MujocoOptions
from explore_bt_drivers.mujoco.track import Track

__all__ = ["InertialUnit"]


class InertialUnit:
    """What the body feels at the physical step nearest to each sample, in ``base_link`` axes."""

    def __init__(self, options: MujocoOptions, rng: np.random.Generator) -> None:
        self._rate_hz = options.imu_rate
        self._rng = rng
        noise = [options.gyro_noise] * 3 + [options.accel_noise] * 3
        bias = [options.gyro_bias] * 3 + [options.accel_bias] * 3
        self._sigma = np.array(noise) if options.noise else np.zeros(6)
        self._bias = rng.standard_normal(6) * bias if options.noise else np.zeros(6)
        self._samples = 0

    def begin(self, track: Track) -> None:
        """Measure from here on: a resumed run begins in the middle."""
        self._samples = track.due(self._rate_hz)

    def measure(self, track: Track) -> list[Imu]:
        """The samples taken since the last call."""
        due = track.due(self._rate_hz)
        stamps = [sample / self._rate_hz for sample in range(self._samples + 1, due + 1)]
        self._samples = due
        if not stamps:
            return []
        rows = [track.row_of(stamp) for stamp in stamps]
        felt = np.hstack((track.angular_velocities[rows], track.linear_accelerations[rows]))
        felt += self._bias + self._sigma * self._rng.standard_normal(felt.shape)
        return [
            Imu(stamp, (row[0], row[1], row[2]), (row[3], row[4], row[5]))
            for stamp, row in zip(stamps, felt.tolist(), strict=True)
        ]
