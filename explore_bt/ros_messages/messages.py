"""From ROS messages to measurements; what does not fit raises ``ValueError`` in words."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from explore_bt.ros_messages.cloud import point_cloud
from explore_bt.ros_messages.mountings import Places, planar, rotation_of
from explore_bt.types import Imu, Measurement, PointCloud, Pose2, Scan2D, WheelOdometry

__all__ = ["MESSAGES", "TRANSFORMS", "stamp_of"]

TRANSFORMS = "tf2_msgs/msg/TFMessage"
_SLOWEST_SWEEP_S = 5.0


def _scan(message: Any, mountings: Places, range_max_m: float | None) -> Scan2D:
    """``sensor_msgs/LaserScan``: its stamp is the first beam's (REP-117 for the ranges)."""
    ranges = np.asarray(message.ranges, dtype=np.float64)
    reach_m = float(range_max_m or message.range_max)
    first, step = _finite("angle_min", message.angle_min), _finite("angle_increment", message.angle_increment)
    beam_s = _finite("time_increment", message.time_increment)
    sweep_s = beam_s * max(len(ranges) - 1, 0)
    if not (0.0 <= sweep_s <= _SLOWEST_SWEEP_S):
        raise ValueError(
            f"time_increment is {beam_s:g} s for {len(ranges)} beams; expected a sweep of 0 to 5 s"
        )
    if not reach_m > 0.0:
        raise ValueError(f"range_max is {reach_m:g} m; expected more than 0")
    ranges[ranges >= reach_m] = math.inf
    ranges[ranges <= 0.0] = math.nan
    T = mountings.of(message.header.frame_id)
    angles = first + step * np.arange(len(ranges), dtype=np.float64)
    return Scan2D(
        stamp_of(message) + sweep_s,
        -angles if T[2, 2] < 0.0 else angles,  # a lidar that hangs upside down turns the other way
        ranges.astype(np.float32),
        beam_s * np.arange(len(ranges), dtype=np.float64) - sweep_s,
        max(_finite("range_min", message.range_min), 0.0),
        reach_m,
        message.header.frame_id,
        Pose2(float(T[0, 3]), float(T[1, 3]), planar(T[:3, :3])),
    )


def _imu(message: Any, mountings: Places, _: float | None) -> Imu:
    """``sensor_msgs/Imu``, turned into the axes of ``base_link``."""
    turn = mountings.of(message.header.frame_id)[:3, :3]
    return Imu(
        stamp_of(message),
        _turned(turn, message.angular_velocity, "angular_velocity"),
        _turned(turn, message.linear_acceleration, "linear_acceleration"),
    )


def _odometry(message: Any, _: Places, __: float | None) -> WheelOdometry:
    """``nav_msgs/Odometry``: its pose, in the plane."""
    pose = message.pose.pose
    place = (_finite("position.x", pose.position.x), _finite("position.y", pose.position.y))
    return WheelOdometry(stamp_of(message), Pose2(*place, planar(rotation_of(pose.orientation))))


def _cloud(message: Any, mountings: Places, range_max_m: float | None) -> PointCloud:
    cloud = point_cloud(message, stamp_of(message), mountings.of(message.header.frame_id))
    return cloud if range_max_m is None else replace(cloud, range_max_m=range_max_m)


def stamp_of(message: Any) -> float:
    """Seconds of a message's header."""
    stamp = message.header.stamp
    return float(stamp.sec) + 1e-9 * float(stamp.nanosec)


def _finite(name: str, value: Any) -> float:
    if not math.isfinite(value):
        raise ValueError(f"{name} is {value}; expected a finite number")
    return float(value)


def _turned(rotation: NDArray[np.float64], vector: Any, name: str) -> tuple[float, float, float]:
    values = [_finite(f"{name}.{axis}", getattr(vector, axis)) for axis in "xyz"]
    x, y, z = (rotation @ np.array(values)).tolist()
    return x, y, z


MESSAGES: dict[str, Callable[[Any, Places, float | None], Measurement]] = {
    "sensor_msgs/msg/LaserScan": _scan,
    "sensor_msgs/msg/PointCloud2": _cloud,
    "sensor_msgs/msg/Imu": _imu,
    "nav_msgs/msg/Odometry": _odometry,
}
"""The message types that are played."""
