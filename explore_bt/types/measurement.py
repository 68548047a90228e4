"""What a driver measures: frozen values with a stamp and a frame."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from explore_bt.types.pose import Pose2, Twist2

__all__ = ["Battery", "Imu", "Measurement", "PointCloud", "RgbdFrame", "Scan2D", "WheelOdometry"]


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

    def straightened(self, twist: Twist2) -> Scan2D:
        """As the sweep would look from where the robot stood at ``stamp_s``: to be drawn, not to be mapped.

        Beams keep even steps: each is turned, and made longer or shorter by what was driven along it; what
        was driven across it, at most some centimetres, stays in.

        Args:
            twist: of the robot during the sweep.
        """
        angles = self.angles_rad + twist.angular_rps * self.times_s
        driven = twist.linear_mps * self.times_s * np.cos(angles + self.T_base_sensor.yaw_rad)
        return replace(self, angles_rad=angles, ranges_m=(self.ranges_m + driven).astype(np.float32))


@dataclass(frozen=True, slots=True, eq=False)
class PointCloud:
    """One sweep of a 3D lidar.

    Attributes:
        stamp_s: time of the last point, seconds on the mission's clock.
        points: (N, 3) float32, metres, sensor frame; NaN rows are invalid returns.
        times_s: (N,) float64, each point's time relative to ``stamp_s`` (<= 0), seconds.
        T_base_sensor: (4, 4) float64, pose of the sensor in ``base_link``.
        range_max_m: farther away it sees nothing; +inf where nobody said.
    """

    stamp_s: float
    points: NDArray[np.float32]
    times_s: NDArray[np.float64]
    T_base_sensor: NDArray[np.float64]
    frame: str = "lidar"
    range_max_m: float = math.inf


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


@dataclass(frozen=True, slots=True)
class Battery:
    """State of charge: 1 is full, 0 empty."""

    stamp_s: float
    charge: float
    frame: str = "base_link"


@dataclass(frozen=True, slots=True, eq=False)
class RgbdFrame:
    """One image of an RGB-D camera, depth registered to colour: pixel by pixel the same ray.

    Attributes:
        stamp_s: time of exposure, seconds on the mission's clock.
        image: (H, W) or (H, W, 3) uint8, grey or RGB.
        depth_m: (H, W) float32, metres **along the optical axis** (z, not the ray's length); NaN is "none".
        fx, fy, cx, cy: pinhole intrinsics, pixels, of the undistorted image; (0, 0) is the centre of the
            upper left pixel.
        T_base_sensor: (4, 4) float64, pose of the optical frame (z ahead, x right, y down: REP-103) in
            ``base_link``.
        frame: the optical frame's name.

    Raises:
        ValueError: a shape, type or intrinsic that does not fit.
    """

    stamp_s: float
    image: NDArray[np.uint8]
    depth_m: NDArray[np.float32]
    fx: float
    fy: float
    cx: float
    cy: float
    T_base_sensor: NDArray[np.float64]
    frame: str = "camera_optical"

    def __post_init__(self) -> None:
        faults = [
            *_fault(
                "image", self.image, np.uint8, ((*self.depth_m.shape[:2],), (*self.depth_m.shape[:2], 3))
            ),
            *_fault("depth_m", self.depth_m, np.float32, (self.image.shape[:2],)),
            *_fault("T_base_sensor", self.T_base_sensor, np.float64, ((4, 4),)),
        ]
        if not (np.isfinite([self.fx, self.fy, self.cx, self.cy]).all() and min(self.fx, self.fy) > 0.0):
            faults.append(
                f"fx, fy, cx, cy are {self.fx}, {self.fy}, {self.cx}, {self.cy}; expected fx, fy > 0"
            )
        if faults:
            raise ValueError(f"RgbdFrame of {self.frame}: {'; '.join(faults)}")

    @property
    def grey(self) -> NDArray[np.uint8]:
        """(H, W) uint8: the image without its colour (ITU-R BT.601 luma)."""
        if self.image.ndim == 2:
            return self.image
        weights = np.array([77, 150, 29], dtype=np.uint32)
        return ((self.image.astype(np.uint32) @ weights + 128) >> 8).astype(np.uint8)


Measurement: TypeAlias = Scan2D | PointCloud | Imu | WheelOdometry | RgbdFrame | Battery


def _fault(
    name: str, array: NDArray[np.generic], dtype: type[np.generic], shapes: tuple[tuple[int, ...], ...]
) -> list[str]:
    """What is wrong with an array, in words; nothing if nothing is."""
    if array.dtype == dtype and array.shape in shapes:
        return []
    wanted = " or ".join(map(str, shapes))
    return [f"{name} is {array.dtype} of shape {array.shape}; expected {dtype.__name__} of shape {wanted}"]
