"""Small bags of both ROS families, written with rosbags."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
from rosbags.rosbag1 import Writer as Writer1
from rosbags.rosbag2 import StoragePlugin
from rosbags.rosbag2 import Writer as Writer2
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

STORE1, STORE2 = get_typestore(Stores.ROS1_NOETIC), get_typestore(Stores.ROS2_HUMBLE)
STORE1.register(get_types_from_msg("geometry_msgs/TransformStamped[] transforms", "tf2_msgs/msg/TFMessage"))


class Messages:
    """Messages of one of the two families."""

    def __init__(self, store: Any) -> None:
        self.store = store
        self.is1 = store is STORE1

    def of(self, name: str, *values: Any, **named: Any) -> Any:
        return self.store.types[name](*values, **named)

    def header(self, stamp_s: float, frame: str) -> Any:
        second = math.floor(stamp_s)
        stamp = self.of("builtin_interfaces/msg/Time", second, round(1e9 * (stamp_s - second)))
        more = {"seq": 0} if self.is1 else {}
        return self.of("std_msgs/msg/Header", stamp=stamp, frame_id=frame, **more)

    def vector(self, x: float, y: float, z: float) -> Any:
        return self.of("geometry_msgs/msg/Vector3", x, y, z)

    def quaternion(self, w: float, x: float, y: float, z: float) -> Any:
        return self.of("geometry_msgs/msg/Quaternion", x, y, z, w)

    def scan(self, stamp_s: float, ranges: list[float], **changed: Any) -> Any:
        fields = {
            "angle_min": -1.0,
            "angle_max": 1.0,
            "angle_increment": 0.5,
            "time_increment": 0.01,
            "scan_time": 0.1,
            "range_min": 0.1,
            "range_max": 10.0,
            **changed,
        }
        return self.of(
            "sensor_msgs/msg/LaserScan",
            header=self.header(stamp_s, fields.pop("frame", "laser")),
            ranges=np.array(ranges, dtype=np.float32),
            intensities=np.zeros(0, dtype=np.float32),
            **fields,
        )

    def imu(self, stamp_s: float, rate: tuple[float, ...], acceleration: tuple[float, ...]) -> Any:
        nine = np.zeros(9)
        return self.of(
            "sensor_msgs/msg/Imu",
            header=self.header(stamp_s, "imu"),
            orientation=self.quaternion(1, 0, 0, 0),
            orientation_covariance=nine,
            angular_velocity=self.vector(*rate),
            angular_velocity_covariance=nine,
            linear_acceleration=self.vector(*acceleration),
            linear_acceleration_covariance=nine,
        )

    def odometry(self, stamp_s: float, x: float, y: float, turn: tuple[float, ...]) -> Any:
        place, still = self.of("geometry_msgs/msg/Point", x, y, 0.0), self.vector(0, 0, 0)
        pose = self.of("geometry_msgs/msg/Pose", position=place, orientation=self.quaternion(*turn))
        twist = self.of("geometry_msgs/msg/Twist", linear=still, angular=still)
        return self.of(
            "nav_msgs/msg/Odometry",
            header=self.header(stamp_s, "odom"),
            child_frame_id="base_link",
            pose=self.of("geometry_msgs/msg/PoseWithCovariance", pose=pose, covariance=np.zeros(36)),
            twist=self.of("geometry_msgs/msg/TwistWithCovariance", twist=twist, covariance=np.zeros(36)),
        )

    def transforms(self, *links: tuple[str, str, tuple[float, ...], tuple[float, ...]]) -> Any:
        return self.of(
            "tf2_msgs/msg/TFMessage",
            transforms=[
                self.of(
                    "geometry_msgs/msg/TransformStamped",
                    header=self.header(0.0, parent),
                    child_frame_id=child,
                    transform=self.of(
                        "geometry_msgs/msg/Transform",
                        translation=self.vector(*shift),
                        rotation=self.quaternion(*turn),
                    ),
                )
                for parent, child, shift, turn in links
            ],
        )

    def cloud(self, stamp_s: float, points: np.ndarray, times_ns: list[int]) -> Any:
        table = np.zeros(len(points), dtype=[("x", "<f4"), ("y", "<f4"), ("z", "<f4"), ("t", "<u4")])
        for axis, name in enumerate("xyz"):
            table[name] = points[:, axis]
        table["t"] = times_ns
        fields = [
            self.of("sensor_msgs/msg/PointField", name, 4 * index, 6 if name == "t" else 7, 1)
            for index, name in enumerate("xyzt")
        ]
        return self.of(
            "sensor_msgs/msg/PointCloud2",
            header=self.header(stamp_s, "laser"),
            height=1,
            width=len(points),
            fields=fields,
            is_bigendian=False,
            point_step=16,
            row_step=16 * len(points),
            data=np.frombuffer(table.tobytes(), dtype=np.uint8),
            is_dense=True,
        )

    def image(
        self, stamp_s: float, pixels: np.ndarray, encoding: str, frame: str = "optical", **changed: Any
    ) -> Any:
        rows = np.ascontiguousarray(pixels).view(np.uint8).reshape(len(pixels), -1)
        fields = {
            "height": pixels.shape[0],
            "width": pixels.shape[1],
            "is_bigendian": 0,
            "step": rows.shape[1],
            "data": rows.ravel(),
            **changed,
        }
        header = self.header(stamp_s, frame)
        return self.of("sensor_msgs/msg/Image", header=header, encoding=encoding, **fields)

    def camera_info(self, stamp_s: float, size: tuple[int, int], focal: float, *D: float) -> Any:
        width, height = size
        K = np.array([focal, 0, width / 2, 0, focal, height / 2, 0, 0, 1.0])
        P = np.hstack((K.reshape(3, 3), np.zeros((3, 1)))).ravel()
        matrices = {"D": np.array(D or (0.0,) * 5), "K": K, "R": np.eye(3).ravel(), "P": P}
        roi = self.of(
            "sensor_msgs/msg/RegionOfInterest", x_offset=0, y_offset=0, height=0, width=0, do_rectify=False
        )
        return self.of(
            "sensor_msgs/msg/CameraInfo",
            header=self.header(stamp_s, "optical"),
            height=height,
            width=width,
            distortion_model="plumb_bob",
            binning_x=0,
            binning_y=0,
            roi=roi,
            **{name if self.is1 else name.lower(): value for name, value in matrices.items()},
        )


def write_bag1(folder: Path, messages: list[tuple[str, Any]]) -> Path:
    path = folder / "drive.bag"
    with Writer1(path) as writer:
        _fill(writer, STORE1, STORE1.serialize_ros1, messages)
    return path


def write_bag2(folder: Path, messages: list[tuple[str, Any]], storage: StoragePlugin) -> Path:
    path = folder / "drive"
    with Writer2(path, version=9, storage_plugin=storage) as writer:
        _fill(writer, STORE2, STORE2.serialize_cdr, messages)
    return path


def _fill(writer: Any, store: Any, serialize: Any, messages: list[tuple[str, Any]]) -> None:
    connections: dict[str, Any] = {}
    for index, (topic, message) in enumerate(messages):
        kind = message.__msgtype__
        if topic not in connections:
            connections[topic] = writer.add_connection(topic, kind, typestore=store)
        writer.write(connections[topic], 10_000_000 * index, bytes(serialize(message, kind)))


FAMILIES = {
    "ros1": (Messages(STORE1), write_bag1),
    "sqlite": (Messages(STORE2), lambda folder, found: write_bag2(folder, found, StoragePlugin.SQLITE3)),
    "mcap": (Messages(STORE2), lambda folder, found: write_bag2(folder, found, StoragePlugin.MCAP)),
}
