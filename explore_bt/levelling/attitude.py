"""Which way is down: the gyroscope's attitude, held to gravity by what the robot's speed says.

An accelerometer on a driving robot shows gravity and driving at once, so its direction alone is no plumb
line. But driving cannot go on: its integral is the robot's speed, which registration measures. So the filter
integrates gyroscope and accelerometer to a velocity in level axes; where that differs from the speed over
ground, the attitude is tilted, as 1° for one second makes 0.17 m/s (velocity-aided attitude, Farrell 2008,
ch. 10). An error-state filter over seven numbers: tilt about the level axes (2), velocity in level axes (2),
gyroscope bias in ``base_link`` (3).
"""

from __future__ import annotations

import math
from collections import deque
from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray

from explore_bt.levelling.arrays import Floats
from explore_bt.types import Imu

__all__ = ["AttitudeFilter", "AttitudeNoise"]

_GRAVITY_MPS2 = 9.81
_IMU_SILENCE_S = 0.1
_HISTORY_S = 0.5


@dataclass(frozen=True, slots=True)
class AttitudeNoise:
    """Spectral densities of what drives the errors, and their spread at the start."""

    gyro: float = 0.002  # rad/√s
    accelerometer: float = 0.02  # m/s/√s
    gyro_bias_walk: float = 1e-4  # rad/s/√s
    tilt: float = 0.05  # rad: the first sample's word for down
    velocity: float = 0.1  # m/s: a mission starts at rest
    gyro_bias: float = 0.01  # rad/s


class AttitudeFilter:
    """Attitude of ``base_link`` in axes whose z points up; yaw is only integrated, from 0 at the start."""

    def __init__(self, noise: AttitudeNoise | None = None) -> None:
        self._noise = noise or AttitudeNoise()
        self._rotation = np.eye(3)
        self._velocity = np.zeros(2)
        self._bias = np.zeros(3)
        self._covariance = self._at_start()
        self._yaw_rad = 0.0
        self._last: tuple[float, NDArray[np.float64]] | None = None
        self._history: deque[tuple[float, NDArray[np.float64]]] = deque()

    @property
    def rotation(self) -> NDArray[np.float64]:
        """(3, 3) float64: takes ``base_link`` vectors into level axes, yaw included."""
        return self._rotation.copy()

    @property
    def tilt_rad(self) -> tuple[float, float]:
        """Pitch (nose down is positive) and roll, REP-103."""
        R = self._rotation
        return (-math.asin(min(max(float(R[2, 0]), -1.0), 1.0)), math.atan2(float(R[2, 1]), float(R[2, 2])))

    @property
    def gyro_bias_rps(self) -> NDArray[np.float64]:
        """(3,) float64, rad/s, ``base_link`` axes."""
        return self._bias.copy()

    def take_imu(self, imu: Imu) -> Imu:
        """Integrate up to a sample.

        Returns:
            The sample in level axes that turn with the robot: what a level robot would have felt.
        """
        sample = np.array([*imu.angular_velocity_rps, *imu.linear_acceleration_mps2])
        if self._last is None:
            self._rotation = _turn(np.array([0.0, 0.0, self._yaw_rad])) @ _upright(sample[3:])
        else:
            stamp_s, before = self._last
            dt_s = imu.stamp_s - stamp_s
            if dt_s <= 0.0:
                return self._levelled(imu, sample)
            middle = 0.5 * (before + sample) if dt_s < _IMU_SILENCE_S else sample
            noise = np.array([self._noise.gyro, self._noise.accelerometer, self._noise.gyro_bias_walk])
            _propagate(self._rotation, self._velocity, self._bias, self._covariance, middle, dt_s, noise)
        self._last = (imu.stamp_s, sample)
        self._history.append((imu.stamp_s, self._rotation.copy()))
        while self._history[0][0] < imu.stamp_s - _HISTORY_S:
            self._history.popleft()
        return self._levelled(imu, sample)

    def stand(self) -> None:
        """The body stands still now, however it was thrown about: the next sample says where is down."""
        self._yaw_rad = self._heading()
        self._last = None
        self._velocity = np.zeros(2)
        bias = self._covariance[4:, 4:].copy()
        self._covariance = self._at_start()
        self._covariance[4:, 4:] = bias

    def correct(self, velocity_mps: NDArray[np.float64], sigma_mps: float) -> None:
        """The robot moves at this speed: what the accelerometer adds to it is tilt.

        Args:
            velocity_mps: (2,) float64 over ground, axes of the level ``base_link`` (x ahead, y left).
            sigma_mps: its standard deviation; the robot's speed limit if nothing is known (velocity 0).
        """
        yaw = self._heading()
        cos, sin = math.cos(yaw), math.sin(yaw)
        measured = np.array([[cos, -sin], [sin, cos]]) @ velocity_mps
        P = self._covariance
        gain = P[:, 2:4] @ np.linalg.inv(P[2:4, 2:4] + np.eye(2) * sigma_mps**2)
        change = gain @ (measured - self._velocity)
        P = P - gain @ P[2:4, :]
        self._covariance = 0.5 * (P + P.T)
        self._rotation = _turn(np.array([change[0], change[1], 0.0])) @ self._rotation
        self._velocity = self._velocity + change[2:4]
        self._bias = self._bias + change[4:]

    def between(self, stamps_s: NDArray[np.float64]) -> NDArray[np.float64]:
        """(N, 3, 3) float64 attitudes at (N,) times of the last half second, the nearest known beyond.

        Linear between samples, which at 100 Hz and 2 rad/s is off by less than 0.01°.
        """
        if not self._history:
            return np.broadcast_to(np.eye(3), (stamps_s.shape[0], 3, 3)).copy()
        times = np.array([stamp_s for stamp_s, _ in self._history])
        rotations = np.array([rotation for _, rotation in self._history])
        return np.asarray(_interpolated(stamps_s, times, rotations))

    def _at_start(self) -> NDArray[np.float64]:
        spread = [self._noise.tilt] * 2 + [self._noise.velocity] * 2 + [self._noise.gyro_bias] * 3
        return np.diag(np.array(spread) ** 2)

    def _heading(self) -> float:
        return math.atan2(self._rotation[1, 0], self._rotation[0, 0])

    def _levelled(self, imu: Imu, sample: NDArray[np.float64]) -> Imu:
        yaw = self._heading()
        cos, sin = math.cos(yaw), math.sin(yaw)
        level = np.array([[cos, sin, 0.0], [-sin, cos, 0.0], [0.0, 0.0, 1.0]]) @ self._rotation
        rates, forces = (level @ part for part in (sample[:3], sample[3:]))
        return Imu(imu.stamp_s, tuple(rates.tolist()), tuple(forces.tolist()), imu.frame)


def _upright(force: NDArray[np.float64]) -> NDArray[np.float64]:
    """(3, 3) with yaw 0 under which a resting robot would feel this force straight up."""
    length = float(np.linalg.norm(force))
    if length == 0.0:
        return np.eye(3)
    up = force / length
    ahead = np.array([1.0, 0.0, 0.0]) - up[0] * up
    ahead /= max(float(np.linalg.norm(ahead)), 1e-9)
    return np.array([ahead, np.cross(up, ahead), up])


@njit(cache=True)
def _turn(vector: Floats) -> Floats:
    """(3, 3) rotation by a rotation vector, radians (Rodrigues)."""
    angle = np.sqrt(vector[0] ** 2 + vector[1] ** 2 + vector[2] ** 2)
    K = np.zeros((3, 3))
    K[0, 1], K[0, 2], K[1, 0] = -vector[2], vector[1], vector[2]
    K[1, 2], K[2, 0], K[2, 1] = -vector[0], -vector[1], vector[0]
    if angle < 1e-9:
        return np.eye(3) + K
    return np.eye(3) + np.sin(angle) / angle * K + (1.0 - np.cos(angle)) / angle**2 * (K @ K)


@njit(cache=True)
def _propagate(
    rotation: Floats,
    velocity: Floats,
    bias: Floats,
    covariance: Floats,
    sample: Floats,
    dt: float,
    noise: Floats,
) -> None:
    """One step, in place; ``sample`` is rates and forces midway through it."""
    force = np.zeros(3)
    step = (sample[:3] - bias) * dt
    half = rotation @ _turn(0.5 * step)
    for i in range(3):
        force[i] = half[i, 0] * sample[3] + half[i, 1] * sample[4] + half[i, 2] * sample[5]
    rotation[:, :] = rotation @ _turn(step)
    velocity[0] += force[0] * dt
    velocity[1] += force[1] * dt
    F = np.eye(7)
    for i in range(3):
        F[0, 4 + i], F[1, 4 + i] = -half[0, i] * dt, -half[1, i] * dt
    F[2, 1], F[3, 0] = force[2] * dt, -force[2] * dt
    covariance[:, :] = F @ covariance @ F.T
    for i in range(2):
        covariance[i, i] += noise[0] ** 2 * dt
        covariance[2 + i, 2 + i] += noise[1] ** 2 * dt
    for i in range(4, 7):
        covariance[i, i] += noise[2] ** 2 * dt


@njit(cache=True)
def _interpolated(stamps: Floats, times: Floats, rotations: Floats) -> Floats:
    out = np.empty((stamps.shape[0], 3, 3))
    last = times.shape[0] - 1
    for i in range(stamps.shape[0]):
        k = np.searchsorted(times, stamps[i])
        if k == 0 or k > last:
            out[i] = rotations[min(k, last)]
            continue
        share = (stamps[i] - times[k - 1]) / (times[k] - times[k - 1])
        out[i] = rotations[k - 1] + share * (rotations[k] - rotations[k - 1])
    return out
