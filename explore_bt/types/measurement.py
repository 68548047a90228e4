"""What a driver measures: frozen values with a stamp and a frame."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from explore_bt.types.pose import Pose2

__all__ = ["Imu", "Measurement", "PointCloud", "Scan2D", "WheelOdometry"]


@dataclass(frozen=True, slots=True, eq=False)
class Scan2D:
    """One sweep of a planar lidar.

    Attributes:
        stamp_s: time of the **last** beam, seconds on the mission's clock.
        frame: the sensor's frame; ``T_base_sensor`` places it on the robot.
        angles_rad: (N,) float64, beam directions in the sensor frame, counter-clockwise from x.
        ranges_m: (N,) float32, metres. NaN is an invalid return, +inf is "nothing within range":
            the two are never mixed up.
        times_s: (N,) float64, each beam's time relative to ``stamp_s`` (<= 0), seconds.
        range_min_m, range_max_m: the sensor's limits; a return outside them is invalid.
        T_base_sensor: pose of the sensor in ``base_link``.
    """

    stamp_s: float
    angles_rad: NDArray[np.float64]
    ranges_m: NDArray[np.float32]
    times_s: NDArray[np.float64]
    range_min_m: float
    range_max_m: float
    frame: str = "laser"
    T_base_sensor: Pose2 = Pose2(0.0, 0.0, 0.0)

    @property
    def is_return(self) -> NDArray[np.bool_]:
        """(N,) bool: beams that hit something within the sensor's limits."""
        with np.errstate(invalid="ignore"):
            return (self.ranges_m >= self.range_min_m) & (self.ranges_m <= self.range_max_m)

    @property
    def is_invalid(self) -> NDArray[np.bool_]:
        """(N,) bool: beams that tell nothing (NaN, or below the sensor's minimum)."""
        return ~(self.ranges_m >= self.range_min_m)

    def points(self) -> NDArray[np.float64]:
        """(M, 2) float64, metres, base frame: the returns, in beam order, not deskewed."""
        hit = self.is_return
        ranges = self.ranges_m[hit].astype(np.float64)
        angles = self.angles_rad[hit]
        in_sensor = np.column_stack((ranges * np.cos(angles), ranges * np.sin(angles)))
        return self.T_base_sensor.apply(in_sensor)


@dataclass(frozen=True, slots=True, eq=False)
class PointCloud:
    """One sweep of a 3D lidar.

    Attributes:
        stamp_s: time of the last point, seconds on the mission's clock.
        points: (N, 3) float32, metres, sensor frame; NaN rows are invalid returns.
        times_s: (N,) float64, each point's time relative to ``stamp_s`` (<= 0), seconds.
        T_base_sensor: (4, 4) float64, pose of the sensor in ``base_link``.
    """

    stamp_s: float
    points: NDArray[np.float32]
    times_s: NDArray[np.float64]
    T_base_sensor: NDArray[np.float64]
    frame: str = "lidar"


@dataclass(frozen=True, slots=True)
class Imu:
    """One sample of gyroscope and accelerometer in ``base_link`` axes: rad/s and m/s²."""

    stamp_s: float
    angular_velocity_rps: tuple[float, float, float]
    linear_acceleration_mps2: tuple[float, float, float]
    frame: str = "base_link"


@dataclass(frozen=True, slots=True)
class WheelOdometry:
    """Dead reckoning by the wheels: pose of ``base_link`` in ``odom``, drifting without bound."""

    stamp_s: float
    T_odom_base: Pose2
    frame: str = "odom"


Measurement: TypeAlias = Scan2D | PointCloud | Imu | WheelOdometry
