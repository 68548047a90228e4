"""Wheel odometry that slips."""

from __future__ import annotations

import math
from statistics import NormalDist

import numpy as np

from explore_bt.types import Pose2, WheelOdometry, wrap_angle
from explore_bt_drivers.sim2d.body import Track
from explore_bt_drivers.sim2d.options import Sim2dOptions

__all__ = ["Wheels"]

_SLIP_S = 0.5
_SLIP_SHARE = 0.3


class Wheels:
    """Dead reckoning in ``odom``, which begins at the start pose as its origin.

    Driven lengths and turned angles are wrong by a constant share drawn per seed, by noise in proportion
    to the motion, and, while a wheel slips, by a further share drawn for that slip.
    """

    def __init__(self, options: Sim2dOptions, start: Pose2, rng: np.random.Generator) -> None:
        self._rate_hz = options.odometry_rate
        self._rng = rng
        self._noisy = options.noise
        self._noise = options.odometry_noise
        length_error, angle_error = rng.normal(0.0, options.odometry_scale, 2).tolist()
        self._scale = (1.0 + length_error, 1.0 + angle_error)
        chance = 1.0 - math.exp(-options.slip_rate / options.odometry_rate)
        self._slip_above = NormalDist().inv_cdf(1.0 - chance) if chance > 0.0 else math.inf
        self._slip = (0.0, 0.0)
        self._slip_left = 0
        self._reckoned = (0.0, 0.0, 0.0)
        self._true = (start.x, start.y, start.yaw_rad)
        self._samples = 0

    def begin(self, track: Track) -> None:
        """Measure from here on: a resumed run begins in the middle."""
        self._samples = track.due(self._rate_hz)

    def measure(self, track: Track) -> list[WheelOdometry]:
        """The poses reckoned since the last call."""
        due = track.due(self._rate_hz)
        if due == self._samples:
            return []
        stamps = np.arange(self._samples + 1, due + 1) / self._rate_hz
        self._samples = due
        states = track.at(stamps).tolist()
        # one draw of all a motion needs: the stream then does not depend on how the waiting was cut up
        drawn = self._rng.standard_normal((len(stamps), 5)).tolist()
        return [
            WheelOdometry(stamp, self._reckon(state[0], state[1], state[2], draw))
            for stamp, state, draw in zip(stamps.tolist(), states, drawn, strict=True)
        ]

    def _reckon(self, x: float, y: float, yaw: float, draw: list[float]) -> Pose2:
        """The wheels' pose after the body moved on to a true one."""
        x0, y0, yaw0 = self._true
        self._true = (x, y, yaw)
        cos, sin = math.cos(yaw0), math.sin(yaw0)
        length, angle = self._factors(draw) if self._noisy else (1.0, 1.0)
        ahead, aside = length * (cos * (x - x0) + sin * (y - y0)), length * (cos * (y - y0) - sin * (x - x0))
        x1, y1, yaw1 = self._reckoned
        cos, sin = math.cos(yaw1), math.sin(yaw1)
        x1, y1, yaw1 = (
            x1 + cos * ahead - sin * aside,
            y1 + sin * ahead + cos * aside,
            yaw1 + angle * (yaw - yaw0),
        )
        self._reckoned = (x1, y1, yaw1)
        return Pose2(x1, y1, wrap_angle(yaw1))

    def _factors(self, draw: list[float]) -> tuple[float, float]:
        """What the length and the angle of this motion are multiplied by."""
        noise, turn_noise, slip, turn_slip, chance = draw
        if self._slip_left == 0 and chance > self._slip_above:
            self._slip_left = max(round(_SLIP_S * self._rate_hz), 1)
            self._slip = (_SLIP_SHARE * slip, _SLIP_SHARE * turn_slip)
        length = self._scale[0] + self._noise * noise
        angle = self._scale[1] + self._noise * turn_noise
        if self._slip_left > 0:
            self._slip_left -= 1
            length, angle = length + self._slip[0], angle + self._slip[1]
        return (length, angle)
