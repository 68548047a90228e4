"""A robot that pitches as it drives, with a spinning 3D lidar and an IMU: a script, not physics."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from explore_bt.testing.scene3 import Scene3
from explore_bt.types import Imu, Measurement, PointCloud, Pose2, wrap_angle

__all__ = ["BalancingRobot"]

_STEP_S = 0.004
_STEPS_PER_SWEEP = 25
_GRAVITY_MPS2 = 9.81
_KEPT_STEPS = 2 * _STEPS_PER_SWEEP


@dataclass(slots=True)
class BalancingRobot:
    """A unicycle that follows a script exactly while its body pitches and rolls about ``base_link``.

    ``base_link`` is on the floor. IMU at 250 Hz in its origin; lidar at 10 Hz, ``rings`` by ``columns``
    points, one column after another while the robot moves.

    Attributes:
        pose: true pose on the floor now, ``map`` frame.
        time_s: now.
        lidar_height_m: of the sensor above ``base_link``, along the body.
        pitch_rad, pitch_hz, roll_rad: amplitude and rate of the body's swing; it rolls 1.7 times as fast.
        range_noise_m, gyro_noise_rps, accelerometer_noise_mps2: standard deviation of one reading.
        gyro_bias_rps: along all three axes.
        turned_rad: sum of the absolute turns so far.
        driven_m: length of the way so far.
    """

    scene: Scene3
    pose: Pose2
    seed: int = 0
    rings: int = 16
    columns: int = 900
    range_max_m: float = 5.0
    lidar_height_m: float = 0.5
    pitch_rad: float = 0.0
    pitch_hz: float = 0.6
    roll_rad: float = 0.0
    range_noise_m: float = 0.02
    gyro_noise_rps: float = 0.003
    accelerometer_noise_mps2: float = 0.05
    gyro_bias_rps: float = 0.005
    time_s: float = 0.0
    turned_rad: float = 0.0
    driven_m: float = 0.0
    _yaw_rad: float = field(init=False)
    _speed_mps: float = 0.0
    _states: list[tuple[float, ...]] = field(default_factory=list)
    _rng: np.random.Generator = field(init=False)

    def __post_init__(self) -> None:
        self._rng = np.random.default_rng(self.seed)
        self._yaw_rad = self.pose.yaw_rad
        self._note()

    @property
    def mount(self) -> NDArray[np.float64]:
        """(4, 4) float64 ``T_base_sensor``: the lidar straight above ``base_link``."""
        transform = np.eye(4)
        transform[2, 3] = self.lidar_height_m
        return transform

    def drive(self, speed_mps: float, turn_rate_rps: float, duration_s: float) -> Iterator[Measurement]:
        """Drive at a constant twist; what is measured comes out as it happens, so that ``pose`` fits it."""
        for _ in range(round(duration_s / _STEP_S)):
            yield from self._step(speed_mps, turn_rate_rps)

    def go_to(
        self, x: float, y: float, speed_mps: float = 0.5, turn_rate_rps: float = 1.5
    ) -> Iterator[Measurement]:
        """Turn on the spot, then drive straight to a place, speeding up and slowing down."""
        yield from self.turn(
            wrap_angle(math.atan2(y - self.pose.y, x - self.pose.x) - self.pose.yaw_rad), turn_rate_rps
        )
        for speed in _trapezoid(math.hypot(x - self.pose.x, y - self.pose.y), speed_mps, 1.0):
            yield from self._step(float(speed), 0.0)

    def turn(self, angle_rad: float, turn_rate_rps: float = 1.5) -> Iterator[Measurement]:
        """Turn on the spot by an angle, which may be several turns."""
        for rate in _trapezoid(abs(angle_rad), turn_rate_rps, 6.0):
            yield from self._step(0.0, math.copysign(float(rate), angle_rad))

    def _step(self, speed_mps: float, turn_rate_rps: float) -> list[Measurement]:
        middle = self._yaw_rad + 0.5 * turn_rate_rps * _STEP_S
        along_mps2 = (speed_mps - self._speed_mps) / _STEP_S
        self._speed_mps = speed_mps
        x = self.pose.x + math.cos(middle) * speed_mps * _STEP_S
        y = self.pose.y + math.sin(middle) * speed_mps * _STEP_S
        self._yaw_rad += turn_rate_rps * _STEP_S
        self.pose = Pose2(x, y, wrap_angle(self._yaw_rad))
        self.time_s = round(self.time_s + _STEP_S, 6)
        self.turned_rad += abs(turn_rate_rps) * _STEP_S
        self.driven_m += abs(speed_mps) * _STEP_S
        self._note()
        measured: list[Measurement] = [self._imu(along_mps2, speed_mps * turn_rate_rps, turn_rate_rps)]
        if round(self.time_s / _STEP_S) % _STEPS_PER_SWEEP == 0:
            measured.append(self._sweep())
        return measured

    def _swing(self, time_s: NDArray[np.float64] | float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Pitch and roll at a time, growing over the first second so that the start is a standing one."""
        time_s = np.asarray(time_s)
        share, rate = np.clip(time_s - 0.5, 0.0, 1.0), 2.0 * math.pi * self.pitch_hz
        return (
            share * self.pitch_rad * np.sin(rate * time_s),
            share * self.roll_rad * np.sin(1.7 * rate * time_s),
        )

    def _imu(self, along_mps2: float, across_mps2: float, turn_rate_rps: float) -> Imu:
        """Rates from the angles a moment before and after; ZYX Euler kinematics."""
        before, after = self._swing(self.time_s - 1e-4), self._swing(self.time_s + 1e-4)
        pitch, roll = (float(angle) for angle in self._swing(self.time_s))
        pitch_rate, roll_rate = (float(b - a) / 2e-4 for a, b in zip(before, after, strict=True))
        rates = np.array(
            [
                roll_rate - turn_rate_rps * math.sin(pitch),
                pitch_rate * math.cos(roll) + turn_rate_rps * math.cos(pitch) * math.sin(roll),
                -pitch_rate * math.sin(roll) + turn_rate_rps * math.cos(pitch) * math.cos(roll),
            ]
        )
        force = np.array([along_mps2, across_mps2, _GRAVITY_MPS2]) @ _tilt(pitch, roll)
        rates += self.gyro_bias_rps + self._rng.normal(0.0, self.gyro_noise_rps, 3)
        force += self._rng.normal(0.0, self.accelerometer_noise_mps2, 3)
        return Imu(self.time_s, tuple(rates.tolist()), tuple(force.tolist()))

    def _sweep(self) -> PointCloud:
        times = np.repeat((np.arange(self.columns) + 1.0) / self.columns - 1.0, self.rings) * 0.1
        states = np.array(self._states)
        stamps = states[:, 0] - self.time_s
        x, y, yaw = (np.interp(times, stamps, states[:, k]) for k in (1, 2, 3))
        pitch, roll = self._swing(self.time_s + times)
        beams = self._beams()
        turned = _rotated(beams, yaw, pitch, roll)
        origins = _rotated(np.array([[0.0, 0.0, self.lidar_height_m]]), yaw, pitch, roll)
        origins += np.column_stack((x, y, np.zeros_like(x)))
        ranges = self.scene.cast(origins, turned, self.range_max_m)
        ranges = ranges + self._rng.normal(0.0, self.range_noise_m, ranges.shape)
        ranges = np.where((ranges > 0.1) & (ranges <= self.range_max_m), ranges, np.nan)
        points = (beams * ranges[:, None]).astype(np.float32)
        return PointCloud(self.time_s, points, times, self.mount)

    def _beams(self) -> NDArray[np.float64]:
        """(N, 3) unit vectors, column by column; rings from -15° to 15°."""
        azimuth = np.repeat(np.linspace(-math.pi, math.pi, self.columns, endpoint=False), self.rings)
        up = np.tile(np.radians(np.linspace(-15.0, 15.0, self.rings)), self.columns)
        return np.column_stack((np.cos(up) * np.cos(azimuth), np.cos(up) * np.sin(azimuth), np.sin(up)))

    def _note(self) -> None:
        self._states.append((self.time_s, self.pose.x, self.pose.y, self._yaw_rad))
        del self._states[:-_KEPT_STEPS]


def _tilt(pitch: float, roll: float) -> NDArray[np.float64]:
    """(3, 3) Ry(pitch) Rx(roll)."""
    cp, sp, cr, sr = math.cos(pitch), math.sin(pitch), math.cos(roll), math.sin(roll)
    return np.array([[cp, sp * sr, sp * cr], [0.0, cr, -sr], [-sp, cp * sr, cp * cr]])


def _rotated(
    vectors: NDArray[np.float64],
    yaw: NDArray[np.float64],
    pitch: NDArray[np.float64],
    roll: NDArray[np.float64],
) -> NDArray[np.float64]:
    """(N, 3): each vector under its own Rz(yaw) Ry(pitch) Rx(roll)."""
    x, y, z = vectors.T
    y, z = np.cos(roll) * y - np.sin(roll) * z, np.sin(roll) * y + np.cos(roll) * z
    x, z = np.cos(pitch) * x + np.sin(pitch) * z, -np.sin(pitch) * x + np.cos(pitch) * z
    return np.column_stack((np.cos(yaw) * x - np.sin(yaw) * y, np.sin(yaw) * x + np.cos(yaw) * y, z))


def _trapezoid(distance: float, fastest: float, acceleration: float) -> NDArray[np.float64]:
    """Rate in each step of a smooth way of that length: up, level, down; the steps add up to it exactly."""
    fastest = min(fastest, math.sqrt(distance * acceleration))
    ramp_s = fastest / acceleration if distance > 0.0 else 0.0
    total_s = ramp_s + distance / fastest if distance > 0.0 else 0.0
    times = (np.arange(math.ceil(total_s / _STEP_S)) + 0.5) * _STEP_S
    rates = np.minimum(fastest, acceleration * np.minimum(times, np.maximum(total_s - times, 0.0)))
    gone = float(rates.sum()) * _STEP_S
    return rates * (distance / gone) if gone > 0.0 else rates
