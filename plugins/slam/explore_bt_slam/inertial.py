"""Prediction: gyroscope and accelerometer carry the pose from one registered scan to the next.

An error-state filter over eight numbers: pose since the last scan (x, y, yaw), velocity in ``base_link``
(2), accelerometer bias (2), gyroscope bias (1). Registration corrects the pose; velocity and biases
follow through their covariance with it, so the biases are learnt while driving and the speed is carried
through places where the lidar says nothing about it (a plain corridor).
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray

from explore_bt.types import Imu, Pose2, WheelOdometry
from explore_bt_slam.arrays import Floats
from explore_bt_slam.standstill import Standstill
from explore_bt_slam.trail import Trail

__all__ = ["InertialFilter", "InertialNoise"]

_VELOCITY, _AHEAD, _SIDEWAYS, _GYRO_BIAS = slice(3, 5), slice(3, 4), slice(4, 5), slice(7, 8)
"""Where among the eight numbers."""
_IMU_SILENCE_S = 0.1
_SPAN_GAIN = 0.1
_UNDER_WAY_MPS = 0.2
_UNDER_WAY_RPS = 0.3
_STOPPED = np.diag([0.3, 0.3, 0.5]) ** 2
"""How far a robot may have rolled on and turned, m² and rad², when it was stopped and nobody measured."""
_WHEEL_FLOOR = np.array([0.01, 0.01, 0.005])
_WHEEL_SHARE = np.array([[0.1, 0.02], [0.1, 0.02], [0.05, 0.1]])
"""Standard deviations of a step by the wheels: x, y (m), yaw (rad); what is always there, and per metre and
per radian."""


@dataclass(frozen=True, slots=True)
class InertialNoise:
    """Spectral densities of what drives the errors, and the spread of the biases at the start.

    ``*_blind`` hold while no IMU is heard: constant twist is then the only model.
    """

    yaw: float = 0.002  # rad/√s
    velocity: float = 0.02  # m/s/√s
    yaw_blind: float = 0.1
    velocity_blind: float = 0.15
    gyro_bias_walk: float = 1e-4
    accelerometer_bias_walk: float = 2e-3
    gyro_bias: float = 0.02  # rad/s
    accelerometer_bias: float = 0.02  # m/s²
    velocity_start: float = 0.02  # m/s: a mission starts at rest
    odometry: float = 0.05  # m/s
    sideways: float = 0.05  # m/s
    velocity_lost: float = 0.2  # m/s
    gyro_sample: float = 0.005  # rad/s, of one sample at rest


class InertialFilter:
    """Where the robot has got to since the last registered scan, and how sure that is.

    Args:
        speed_limit_mps: the robot cannot go faster.
        noise: see there.
    """

    def __init__(self, speed_limit_mps: float = math.inf, noise: InertialNoise | None = None) -> None:
        self._speed_limit_mps = speed_limit_mps
        self._noise = noise or InertialNoise()
        self._pose = np.zeros(3)
        self._velocity = np.zeros(2)
        self._bias = np.zeros(3)
        spread = [self._noise.velocity_start] * 2 + [self._noise.accelerometer_bias] * 2
        self._covariance = np.diag(np.array([0.0, 0.0, 0.0, *spread, self._noise.gyro_bias]) ** 2)
        self._yaw_rate_rps = 0.0
        self._time_s: float | None = None
        self._imu_s = -math.inf
        self._imu = (0.0, 0.0, 0.0)
        self._standstill = Standstill()
        self._odometry: WheelOdometry | None = None
        self._wheels_s = -math.inf
        self._span_s = 0.0
        self._times: list[float] = []
        self._poses: list[NDArray[np.float64]] = []

    @property
    def time_s(self) -> float | None:
        """How far the prediction reaches; None before the first measurement."""
        return self._time_s

    @property
    def is_blind(self) -> bool:
        """Neither IMU nor wheels speak: that the motion goes on as it was is all there is."""
        return self._time_s is None or self._time_s - max(self._imu_s, self._wheels_s) > _IMU_SILENCE_S

    @property
    def feels_turns(self) -> bool:
        """A gyroscope speaks: how far the robot has turned is known, whatever the wheels did."""
        return self._time_s is not None and self._time_s - self._imu_s <= _IMU_SILENCE_S

    @property
    def _is_under_way(self) -> bool:
        speed_mps = float(np.hypot(self._velocity[0], self._velocity[1]))
        return speed_mps > _UNDER_WAY_MPS or abs(self._yaw_rate_rps) > _UNDER_WAY_RPS

    @property
    def motion(self) -> Pose2:
        """Predicted motion since the last registered scan."""
        x, y, yaw = self._pose
        return Pose2(float(x), float(y), float(yaw))

    @property
    def velocity_mps(self) -> NDArray[np.float64]:
        """(2,) float64: velocity in ``base_link``, m/s."""
        return self._velocity.copy()

    @property
    def covariance(self) -> NDArray[np.float64]:
        """(3, 3) float64: of the predicted pose, in the axes of the predicted ``base_link``."""
        return _turned(self._covariance, self._pose[2])[:3, :3]

    @property
    def trail(self) -> Trail:
        """The predicted way since the last registered scan."""
        return Trail(np.array(self._times), np.array(self._poses))

    def take_imu(self, imu: Imu) -> None:
        """Integrate up to a sample, midway between it and the one before."""
        sample = (imu.angular_velocity_rps[2], *imu.linear_acceleration_mps2[:2])
        if self._time_s is None:
            self._begin(imu.stamp_s)
        held = self._imu if imu.stamp_s - self._imu_s < _IMU_SILENCE_S else sample
        for rate_rps in self._standstill.rates_rps(imu):
            self._measure(_GYRO_BIAS, np.array([rate_rps]), self._noise.gyro_sample)
        self._imu_s = imu.stamp_s
        self._imu = (0.5 * (held[0] + sample[0]), 0.5 * (held[1] + sample[1]), 0.5 * (held[2] + sample[2]))
        self.advance_to(imu.stamp_s)
        self._imu = sample

    def take_odometry(self, odometry: WheelOdometry) -> None:
        """Let the wheels correct the velocity; while no IMU is heard they are the prediction itself.

        A reading that repeats the last one to the bit while the robot was under way is a stalled link, not
        a halt: the next fresh one then tells about the whole time in between.
        """
        last = self._odometry
        if last is not None and odometry.T_odom_base == last.T_odom_base and self._is_under_way:
            return
        self._odometry = odometry
        if last is None or odometry.stamp_s <= last.stamp_s:
            return
        step, span_s = last.T_odom_base.between(odometry.T_odom_base), odometry.stamp_s - last.stamp_s
        if odometry.stamp_s - self._imu_s > _IMU_SILENCE_S:
            self._roll_on(step, span_s, odometry.stamp_s)
        elif span_s < 1.0:
            measured = np.array([step.x, step.y]) / span_s
            self._measure(_VELOCITY, measured, self._noise.odometry)

    def take_speed(self, along_mps: float, sigma_mps: float) -> None:
        """The speed ahead, as the camera saw it go by."""
        self._measure(_AHEAD, np.array([along_mps]), sigma_mps)

    def roll(self) -> None:
        """A robot on wheels does not slide sideways (the paper's unicycle), nor go faster than it can."""
        self._measure(_SIDEWAYS, np.zeros(1), self._noise.sideways)
        speed_mps, most_mps = float(self._velocity[0]), self._speed_limit_mps
        if abs(speed_mps) > most_mps:
            most = np.array([math.copysign(most_mps, speed_mps)])
            self._measure(_AHEAD, most, self._noise.sideways)

    def advance_to(self, time_s: float) -> None:
        """Predict up to a time; going back changes nothing."""
        if self._time_s is None:
            self._begin(time_s)
            return
        dt_s = time_s - self._time_s
        if dt_s <= 0.0:
            return
        blind = time_s - self._imu_s > _IMU_SILENCE_S
        rate = self._yaw_rate_rps + self._bias[2] if blind else self._imu[0]
        noise = self._noise
        _propagate(
            self._pose,
            self._velocity,
            self._bias,
            self._covariance,
            np.array([rate, self._imu[1], self._imu[2]]),
            dt_s,
            blind,
            np.array(
                [
                    noise.yaw_blind if blind else noise.yaw,
                    noise.velocity_blind if blind else noise.velocity,
                    noise.accelerometer_bias_walk,
                    noise.gyro_bias_walk,
                ]
            ),
        )
        self._time_s = time_s
        self._times.append(time_s)
        self._poses.append(self._pose.copy())

    def correct(self, motion: Pose2, covariance: NDArray[np.float64]) -> None:
        """Take the registered motion since the last scan as the truth it is, and start anew from here.

        Args:
            motion: from the last scan to now.
            covariance: (3, 3) of the registered pose, **prior included**, predicted ``base_link`` axes.
        """
        turned = _turned(self._covariance, self._pose[2])
        off = self.motion.between(motion)
        gain = turned[3:, :3] @ np.linalg.inv(turned[:3, :3] + np.eye(3) * 1e-12)
        self._apply(np.concatenate((np.zeros(3), gain @ off.as_array())))
        turned[3:, 3:] -= gain @ (turned[:3, :3] - covariance) @ gain.T
        turned[3:, :3] = gain @ covariance
        turned[:3, 3:] = turned[3:, :3].T
        turned[:3, :3] = covariance
        self._covariance = 0.5 * (turned + turned.T)
        span_s = self._times[-1] - self._times[0]
        if span_s > 0.0:
            # stamps of some loggers jitter down to a millisecond: such a span says nothing about a rate
            self._span_s += _SPAN_GAIN * (span_s - self._span_s) if self._span_s else span_s
            self._yaw_rate_rps = motion.yaw_rad / max(span_s, self._span_s)
        self._restart()

    def stand(self) -> None:
        """The robot was stopped while nobody measured: it rests, about where it was predicted to be."""
        self._restart()
        self._velocity, self._yaw_rate_rps = np.zeros(2), 0.0
        self._imu_s = self._wheels_s = -math.inf
        self._odometry = None
        self._covariance[3:5, :] = self._covariance[:, 3:5] = 0.0
        self._covariance[3:5, 3:5] = np.eye(2) * self._noise.velocity_start**2
        self.anchor(_STOPPED)

    def arrays(self) -> dict[str, NDArray[np.float64]]:
        """Speed, biases and how sure they are; the pose counts from where it is now."""
        return {
            "filter_time": np.array(math.nan if self._time_s is None else self._time_s),
            "filter_velocity": self._velocity.copy(),
            "filter_bias": self._bias.copy(),
            "filter_covariance": self._covariance.copy(),
            "filter_rates": np.array([self._yaw_rate_rps, self._imu_s, *self._imu, self._span_s]),
        }

    def restore(self, arrays: Mapping[str, NDArray[np.float64]]) -> None:
        """Predict on from there; nothing where a map was saved without these."""
        if "filter_time" not in arrays or math.isnan(arrays["filter_time"]):
            return
        self._velocity, self._bias = arrays["filter_velocity"].copy(), arrays["filter_bias"].copy()
        self._covariance = arrays["filter_covariance"].copy()
        self._yaw_rate_rps, self._imu_s, *imu, self._span_s = arrays["filter_rates"].tolist()
        self._imu = (imu[0], imu[1], imu[2])
        self._standstill.end()
        self._begin(float(arrays["filter_time"]))

    def distrust(self) -> NDArray[np.float64]:
        """The prediction was proved wrong: the pose is as good as unknown, the speed unsure.

        Returns:
            The (3, 3) covariance of the prediction from now on, base axes.
        """
        self.anchor(np.eye(3))
        self._covariance[3:5, 3:5] += np.eye(2) * self._noise.velocity_lost**2
        return np.eye(3)

    def anchor(self, covariance: NDArray[np.float64]) -> None:
        """The pose becomes a keyframe: from now on errors are counted from it."""
        self._covariance[:3, :] = 0.0
        self._covariance[:, :3] = 0.0
        self._covariance[:3, :3] = covariance

    def _roll_on(self, step: Pose2, span_s: float, stamp_s: float) -> None:
        """Move by what the wheels did, except for the time that the prediction has covered already."""
        now_s = self._time_s if self._time_s is not None else stamp_s - span_s
        if self._time_s is None:
            self._begin(now_s)
        share = min(max((stamp_s - now_s) / span_s, 0.0), 1.0)
        if share == 0.0:
            return
        moved = np.array([step.x, step.y, step.yaw_rad]) * share
        here = self.motion
        there = here.compose(Pose2(*moved.tolist()))
        length_turn = np.array([math.hypot(moved[0], moved[1]), abs(moved[2])])
        F, spread = np.eye(8), np.zeros((8, 8))
        F[0, 2], F[1, 2] = here.y - there.y, there.x - here.x
        F[3:5, 3:5] = 0.0
        spread[:3, :3] = np.diag((_WHEEL_FLOOR * share + _WHEEL_SHARE @ length_turn) ** 2)
        spread[3:5, 3:5] = np.eye(2) * self._noise.odometry**2
        self._covariance = F @ self._covariance @ F.T + spread
        self._pose = np.array([there.x, there.y, self._pose[2] + moved[2]])
        self._velocity = np.array([step.x, step.y]) / span_s
        self._yaw_rate_rps = step.yaw_rad / span_s
        self._wheels_s = self._time_s = stamp_s
        self._times.append(stamp_s)
        self._poses.append(self._pose.copy())

    def loosen(self, spread: NDArray[np.float64]) -> None:
        """The prediction is less sure than the clock makes it: add (3, 3) to the pose's covariance."""
        self._covariance[:3, :3] += spread

    def _measure(self, part: slice, measured: NDArray[np.float64], sigma: float) -> None:
        """A direct look at a ``part`` of the eight numbers."""
        P = self._covariance
        expected = np.concatenate((self._pose, self._velocity, self._bias))[part]
        gain = P[:, part] @ np.linalg.inv(P[part, part] + np.eye(measured.shape[0]) * sigma**2)
        self._apply(gain @ (measured - expected))
        P = P - gain @ P[part, :]
        self._covariance = 0.5 * (P + P.T)

    def _begin(self, time_s: float) -> None:
        self._time_s = time_s
        self._restart()

    def _restart(self) -> None:
        self._pose = np.zeros(3)
        self._times = [] if self._time_s is None else [self._time_s]
        self._poses = [np.zeros(3)]

    def _apply(self, change: NDArray[np.float64]) -> None:
        self._pose = self._pose + change[:3]
        self._velocity = self._velocity + change[3:5]
        self._bias = self._bias + change[5:]


def _turned(covariance: NDArray[np.float64], yaw_rad: float) -> NDArray[np.float64]:
    """The covariance with its position taken from the last scan's axes into the predicted ones."""
    rotation = np.eye(8)
    cos, sin = math.cos(yaw_rad), math.sin(yaw_rad)
    rotation[:2, :2] = [[cos, sin], [-sin, cos]]
    return rotation @ covariance @ rotation.T


@njit(cache=True)
def _propagate(
    pose: Floats,
    velocity: Floats,
    bias: Floats,
    covariance: Floats,
    imu: Floats,
    dt: float,
    blind: bool,
    noise: Floats,
) -> None:
    """One step of the error-state filter, in place; ``imu`` is yaw rate and acceleration along x, y."""
    rate = imu[0] - bias[2]
    vx, vy = velocity[0], velocity[1]
    middle = pose[2] + 0.5 * rate * dt
    cos, sin = np.cos(middle), np.sin(middle)
    F = np.eye(8)
    F[0, 2], F[1, 2] = (-sin * vx - cos * vy) * dt, (cos * vx - sin * vy) * dt
    F[0, 3], F[0, 4], F[1, 3], F[1, 4] = cos * dt, -sin * dt, sin * dt, cos * dt
    F[2, 7] = -dt
    ax, ay = 0.0, 0.0
    if not blind:
        ax, ay = imu[1] - bias[0] + rate * vy, imu[2] - bias[1] - rate * vx
        F[3, 4], F[4, 3] = rate * dt, -rate * dt
        F[3, 5], F[4, 6] = -dt, -dt
        F[3, 7], F[4, 7] = -vy * dt, vx * dt
    mean_x, mean_y = vx + 0.5 * ax * dt, vy + 0.5 * ay * dt
    pose[0] += (cos * mean_x - sin * mean_y) * dt
    pose[1] += (sin * mean_x + cos * mean_y) * dt
    pose[2] += rate * dt
    velocity[0] += ax * dt
    velocity[1] += ay * dt
    covariance[:, :] = F @ covariance @ F.T
    covariance[2, 2] += noise[0] ** 2 * dt
    for i in range(2):
        covariance[3 + i, 3 + i] += noise[1] ** 2 * dt
        covariance[5 + i, 5 + i] += noise[2] ** 2 * dt
    covariance[7, 7] += noise[3] ** 2 * dt
