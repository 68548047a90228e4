"""From measurements to ROS messages: what ``explore_bt.ros_messages`` does, the other way round."""

from __future__ import annotations

import array
import math
from collections.abc import Callable
from typing import Any

import numpy as np
from nav_msgs.msg import Odometry
from numpy.typing import NDArray
from sensor_msgs.msg import BatteryState, CameraInfo, Image, Imu, LaserScan, PointCloud2, PointField

from explore_bt.types import Battery, PointCloud, Pose2, RgbdFrame, Scan2D, WheelOdometry
from explore_bt.types import Imu as ImuSample
from explore_bt_ros2.stamps import stamp_message

__all__ = ["battery", "camera", "cloud", "imu", "odometry", "place_of", "scan"]

Stamp = Callable[[float], float]


def scan(measured: Scan2D, ros_s: Stamp) -> Any:
    """``LaserScan``, stamped with its first beam."""
    count = len(measured.ranges_m)
    sweep_s = -float(measured.times_s[0]) if count else 0.0
    message = _headed(LaserScan(), ros_s(measured.stamp_s - sweep_s), measured.frame)
    angles = measured.angles_rad
    message.angle_min, message.angle_max = float(angles[0]), float(angles[-1])
    message.angle_increment = float((angles[-1] - angles[0]) / max(count - 1, 1))
    message.time_increment = sweep_s / max(count - 1, 1)
    message.scan_time = sweep_s
    message.range_min, message.range_max = measured.range_min_m, measured.range_max_m
    message.ranges = array.array("f", measured.ranges_m.tobytes())
    return message


def cloud(measured: PointCloud, ros_s: Stamp) -> Any:
    """``PointCloud2`` with x, y, z and the time of each point, stamped with the first."""
    sweep_s = -float(measured.times_s.min(initial=0.0))
    message = _headed(PointCloud2(), ros_s(measured.stamp_s - sweep_s), measured.frame)
    table = np.empty((len(measured.points), 4), dtype="<f4")
    table[:, :3], table[:, 3] = measured.points, measured.times_s + sweep_s
    message.height, message.width, message.point_step = 1, len(table), 16
    message.row_step = 16 * len(table)
    message.fields = [
        PointField(name=name, offset=4 * index, datatype=PointField.FLOAT32, count=1)
        for index, name in enumerate(("x", "y", "z", "time"))
    ]
    message.data = array.array("B", table.tobytes())
    return message


def imu(measured: ImuSample, ros_s: Stamp) -> Any:
    """``Imu`` that knows no orientation."""
    message = _headed(Imu(), ros_s(measured.stamp_s), measured.frame)
    rate, acceleration = message.angular_velocity, message.linear_acceleration
    rate.x, rate.y, rate.z = measured.angular_velocity_rps
    acceleration.x, acceleration.y, acceleration.z = measured.linear_acceleration_mps2
    message.orientation_covariance[0] = -1.0
    return message


def odometry(measured: WheelOdometry, ros_s: Stamp, base_frame: str) -> Any:
    """``Odometry`` without its twist."""
    message = _headed(Odometry(), ros_s(measured.stamp_s), measured.frame)
    message.child_frame_id = base_frame
    pose, place = measured.T_odom_base, message.pose.pose
    place.position.x, place.position.y = pose.x, pose.y
    place.orientation.z, place.orientation.w = math.sin(0.5 * pose.yaw_rad), math.cos(0.5 * pose.yaw_rad)
    return message


def battery(measured: Battery, ros_s: Stamp) -> Any:
    """``BatteryState`` with the charge alone."""
    message = _headed(BatteryState(), ros_s(measured.stamp_s), measured.frame)
    message.percentage, message.present = float(measured.charge), True
    return message


def camera(measured: RgbdFrame, ros_s: Stamp) -> tuple[Any, Any, Any]:
    """Colour ``Image``, depth ``Image``, ``CameraInfo``."""
    stamp_s = ros_s(measured.stamp_s)
    encoding = "mono8" if measured.image.ndim == 2 else "rgb8"
    view = _image(measured.image, encoding, stamp_s, measured.frame)
    depth = _image(measured.depth_m, "32FC1", stamp_s, measured.frame)
    info = _headed(CameraInfo(), stamp_s, measured.frame)
    info.height, info.width = measured.depth_m.shape
    info.distortion_model = "plumb_bob"
    info.d = array.array("d", [0.0] * 5)
    info.k = np.array([measured.fx, 0, measured.cx, 0, measured.fy, measured.cy, 0, 0, 1], dtype=np.float64)
    info.r = np.eye(3).reshape(-1)
    info.p = np.array(
        [measured.fx, 0, measured.cx, 0, 0, measured.fy, measured.cy, 0, 0, 0, 1, 0], dtype=np.float64
    )
    return view, depth, info


def place_of(measured: Any) -> NDArray[np.float64] | None:
    """(4, 4) float64 ``T_base_sensor``; None where the sensor has no place of its own."""
    T = getattr(measured, "T_base_sensor", None)
    if not isinstance(T, Pose2):
        return T
    cosine, sine = math.cos(T.yaw_rad), math.sin(T.yaw_rad)
    return np.array([[cosine, -sine, 0, T.x], [sine, cosine, 0, T.y], [0, 0, 1, 0], [0, 0, 0, 1.0]])


def _image(pixels: NDArray[Any], encoding: str, stamp_s: float, frame: str) -> Any:
    message = _headed(Image(), stamp_s, frame)
    message.height, message.width = pixels.shape[:2]
    message.encoding = encoding
    message.step = pixels.strides[0] if pixels.flags.c_contiguous else pixels.nbytes // pixels.shape[0]
    message.data = array.array("B", np.ascontiguousarray(pixels).tobytes())
    return message


def _headed(message: Any, stamp_s: float, frame: str) -> Any:
    message.header.stamp = stamp_message(stamp_s)
    message.header.frame_id = frame
    return message
