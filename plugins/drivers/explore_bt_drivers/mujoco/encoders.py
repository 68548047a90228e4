"""Dead reckoning from the wheels' encoders."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from explore_bt.types import Pose2, WheelOdometry, wrap_angle
from explore_bt_drivers.mujoco.body import pitch_of
from explore_bt_drivers.mujoco.figures import TRACK_M, WHEEL_RADIUS_M
from explore_bt_drivers.mujoco.options import MujocoOptions
from explore_bt_drivers.mujoco.track import Track

__all__ = ["Encoders"]

_TICKS_PER_TURN = 4096


class Encoders:
    """Pose of ``base_link`` in ``odom``, which begins as its origin.

    An encoder counts a wheel's turn against the body, so the body's pitch is added, as its own attitude
    reference has it. Each wheel's radius is wrong by a constant share drawn per seed, its motions by noise in
    proportion to them; what the wheels slip on the floor is the physics' own error.
    """

    def __init__(self, options: MujocoOptions, rng: np.random.Generator) -> None:
        self._rate_hz = options.odometry_rate
        self._rng = rng
        scale = rng.standard_normal(2) * options.odometry_scale
        self._radii = WHEEL_RADIUS_M * (1.0 + scale) if options.noise else np.full(2, WHEEL_RADIUS_M)
        self._noise = options.odometry_noise if options.noise else 0.0
        self._step_rad = 2.0 * math.pi / _TICKS_PER_TURN
        self._samples = 0
        self._before = np.zeros(2)
        self._reckoned = (0.0, 0.0, 0.0)

    def begin(self, track: Track) -> None:
        """Measure from here on: a resumed run begins in the middle."""
        self._samples = track.due(self._rate_hz)
        self._before = self._read(track, -1)

    def measure(self, track: Track) -> list[WheelOdometry]:
        """The poses reckoned since the last call."""
        due = track.due(self._rate_hz)
        stamps = [sample / self._rate_hz for sample in range(self._samples + 1, due + 1)]
        self._samples = due
        return [
            WheelOdometry(stamp, self._reckon(self._read(track, track.row_of(stamp)))) for stamp in stamps
        ]

    def _read(self, track: Track, row: int) -> NDArray[np.float64]:
        """(2,) how far each wheel has turned against the floor's vertical, radians, in whole ticks."""
        counted = np.round(track.wheels_rad[row] / self._step_rad) * self._step_rad
        return np.asarray(counted + pitch_of(*track.quaternions[row].tolist()))

    def _reckon(self, turned: NDArray[np.float64]) -> Pose2:
        ways = (turned - self._before) * self._radii
        self._before = turned
        left, right = (ways * (1.0 + self._noise * self._rng.standard_normal(2))).tolist()
        x, y, yaw = self._reckoned
        way, turn = 0.5 * (left + right), (right - left) / TRACK_M
        middle = yaw + 0.5 * turn
        self._reckoned = (x + way * math.cos(middle), y + way * math.sin(middle), yaw + turn)
        x, y, yaw = self._reckoned
        return Pose2(x, y, wrap_angle(yaw))
