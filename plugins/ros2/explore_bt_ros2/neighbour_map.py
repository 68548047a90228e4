"""SLAM ``ros2_map``: pose and map come from whatever SLAM runs on the robot."""

from __future__ import annotations

import threading
import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
from nav_msgs.msg import OccupancyGrid as GridMessage
from pydantic import Field
from rclpy.qos import DurabilityPolicy, QoSProfile

from explore_bt.errors import PluginError, UserError
from explore_bt.interfaces import API_VERSION, PluginOptions, RobotContext, Slam
from explore_bt.ros_messages import planar
from explore_bt.types import (
    Estimate,
    GridWindow,
    Health,
    Measurement,
    OccupancyGrid,
    PointCloud,
    Pose2,
    Scan2D,
    Trajectory,
)
from explore_bt.units import Duration
from explore_bt_ros2.connection import Connection
from explore_bt_ros2.grids import GridHistory, grid_of, nothing_known

__all__ = ["Ros2Map", "Ros2MapOptions"]

_JUMP_M, _JUMP_RAD, _DOUBT_S = 0.5, 0.5, 2.0
"""A correction that large moves the robot to another place: it stands for a moment."""
_COVARIANCE = np.diag([0.05**2, 0.05**2, 0.02**2])
"""Of a neighbour that tells none: 5 cm and 1°."""
_FILE = "ros2_map.npz"


class Ros2MapOptions(PluginOptions):
    """Where the neighbour publishes."""

    map_topic: str = Field("map", description="OccupancyGrid of the SLAM on the robot")
    latched: bool = Field(True, description="the map is kept for those who come late (transient local)")
    tf_timeout: Duration = Field(
        2.0, gt=0, description="map → odom on tf, and the newest scan, may be so old"
    )


class Ros2Map(Slam):
    """RTAB-Map, slam_toolbox, Cartographer, AMCL: takes tf and an OccupancyGrid, makes neither."""

    name = "ros2_map"
    api_version = API_VERSION
    Options: ClassVar[type[PluginOptions]] = Ros2MapOptions

    def __init__(self, options: PluginOptions) -> None:
        super().__init__(options)
        self._settings = Ros2MapOptions.model_validate(options.model_dump())
        self._connection: Connection | None = None
        self._lock = threading.Lock()
        self._message: Any = None
        self._history = GridHistory(nothing_known(Pose2.identity()))
        self._pose = Pose2.identity()
        self._stamp_s = 0.0
        self._heard_s = 0.0
        self._scan_s: float | None = None
        self._fault = ""
        self._doubt_until_s = 0.0
        self._has_map = self._has_pose = False
        self._stamps: list[float] = []
        self._poses: list[tuple[float, float, float]] = []
        self._took_ms: list[float] = []

    def setup(self, context: RobotContext) -> None:
        """Subscribe to the map, through the driver's node.

        Raises:
            PluginError: the driver is not ``ros2``.
        """
        if not isinstance(context.connection, Connection):
            raise PluginError("slam ros2_map needs driver ros2: write driver: {use: ros2}")
        self._connection = connection = context.connection
        connection.has_neighbour_map.set()
        self._radius_m = context.footprint_radius_m
        self._pose = context.start or Pose2.identity()
        self._history = GridHistory(nothing_known(self._pose))
        durability = DurabilityPolicy.TRANSIENT_LOCAL if self._settings.latched else DurabilityPolicy.VOLATILE
        self._topic = connection.link.full_name(self._settings.map_topic)
        qos = QoSProfile(depth=1, durability=durability)
        connection.link.subscribe(GridMessage, self._topic, self._hear, qos)

    def update(self, measurement: Measurement) -> None:
        """At every scan, look the robot's place up on tf."""
        self._heard_s = max(self._heard_s, measurement.stamp_s)
        if isinstance(measurement, Scan2D | PointCloud):
            if self._scan_s is not None and measurement.stamp_s <= self._scan_s:
                self._fault = (
                    f"a scan is {self._scan_s - measurement.stamp_s:.2f} s older than the one before"
                )
                return
            self._scan_s = measurement.stamp_s
            begun = time.perf_counter()
            self._take_pose(measurement.stamp_s)
            self._take_map()
            self._took_ms.append(1e3 * (time.perf_counter() - begun))

    def estimate(self) -> Estimate:
        """The neighbour's pose; ``lost`` while it is silent, or has just moved the robot far."""
        reason = self._fault or self._blindness()
        if not reason and self._heard_s < self._doubt_until_s:
            reason = "the neighbour's pose has just jumped"
        if not (reason or self._has_map):
            reason = self._no_map()
        health = Health.LOST if reason else Health.OK
        revision = self._history.grid.revision
        return Estimate(self._stamp_s, self._pose, _COVARIANCE.copy(), revision, health, reason)

    def grid(self) -> OccupancyGrid:
        """The neighbour's map, trinary."""
        return self._history.grid

    def changed_since(self, revision: int) -> GridWindow | None:
        """Window of cells that may differ from that revision."""
        return self._history.changed_since(revision)

    def trajectory(self) -> Trajectory:
        """Where the neighbour had the robot at each scan; what it has corrected since stays as it was."""
        return Trajectory(np.array(self._stamps), np.array(self._poses).reshape(-1, 3))

    def figures(self) -> Mapping[str, float]:
        """Scans, maps, milliseconds a scan; the neighbour's graph is its own."""
        median_ms = float(np.median(self._took_ms)) if self._took_ms else 0.0
        return {
            "scans": float(len(self._stamps)),
            "maps": float(self._history.grid.revision),
            "keyframes": 0.0,
            "loop_closures": 0.0,
            "ms_per_scan_median": median_ms,
        }

    def save(self, folder: Path) -> None:
        """The map as it is, and the way; the neighbour saves its own state."""
        folder.mkdir(parents=True, exist_ok=True)
        grid = self.grid()
        way = self.trajectory()
        np.savez_compressed(
            folder / _FILE,
            cells=grid.cells,
            resolution=grid.resolution_m,
            origin=np.array(grid.origin_xy),
            stamps=way.stamps_s,
            poses=way.poses,
        )

    def load(self, folder: Path) -> None:
        """Show the saved map until the neighbour's comes.

        Raises:
            UserError: nothing was saved there by this plugin.
        """
        try:
            with np.load(folder / _FILE) as saved:
                origin = (float(saved["origin"][0]), float(saved["origin"][1]))
                grid = OccupancyGrid(saved["cells"], float(saved["resolution"]), origin, 1)
                self._stamps = saved["stamps"].tolist()
                self._poses = [(x, y, yaw) for x, y, yaw in saved["poses"].tolist()]
        except (OSError, KeyError, ValueError) as error:
            raise UserError(f"{folder / _FILE} holds no map of ros2_map: {error}") from None
        self._history = GridHistory(grid)

    def _hear(self, message: Any) -> None:
        with self._lock:
            self._message = message

    def _take_map(self) -> None:
        with self._lock:
            message, self._message = self._message, None
        if message is None:
            return
        try:
            self._history.add(grid_of(message, self._pose, self._radius_m))
        except ValueError as fault:
            self._fault = f"{self._topic}: {fault}"
            return
        self._has_map = True

    def _take_pose(self, stamp_s: float) -> None:
        assert self._connection is not None
        clock, buffer = self._connection.clock, self._connection.buffer
        options = self._connection.options
        ros_s = clock.stamp_s(stamp_s)
        T = buffer.find(options.map_frame, options.base_frame, ros_s)
        self._fault = self._silence(ros_s) if T is not None else self._untied()
        if T is None or self._fault:
            return
        pose = Pose2(float(T[0, 3]), float(T[1, 3]), planar(T[:3, :3]))
        off = self._pose.between(pose)
        if self._has_pose and ((off.x**2 + off.y**2) ** 0.5 > _JUMP_M or abs(off.yaw_rad) > _JUMP_RAD):
            self._doubt_until_s = stamp_s + _DOUBT_S
        self._pose, self._has_pose = pose, True
        newest_s = buffer.newest_s(options.odom_frame, options.base_frame)
        late_s = max(ros_s - newest_s, 0.0) if newest_s is not None else 0.0
        self._stamp_s = max(stamp_s - late_s, self._stamp_s)
        self._stamps.append(stamp_s)
        self._poses.append((pose.x, pose.y, pose.yaw_rad))

    def _silence(self, ros_s: float) -> str:
        assert self._connection is not None
        options = self._connection.options
        newest_s = self._connection.buffer.newest_s(options.map_frame, options.base_frame)
        age_s = 0.0 if newest_s is None else ros_s - newest_s
        if age_s <= self._settings.tf_timeout:
            return ""
        return f"tf {options.map_frame} → {options.base_frame} is {age_s:.1f} s old: does the SLAM still run?"

    def _blindness(self) -> str:
        silent_s = 0.0 if self._scan_s is None else self._heard_s - self._scan_s
        return f"no scan for {silent_s:.1f} s" if silent_s > self._settings.tf_timeout else ""

    def _untied(self) -> str:
        assert self._connection is not None
        options = self._connection.options
        frames = ", ".join(self._connection.buffer.frames()) or "none"
        return f"nothing on tf ties {options.base_frame} to {options.map_frame}; frames on tf: {frames}"

    def _no_map(self) -> str:
        assert self._connection is not None
        mismatch = self._connection.link.mismatches.get(self._topic)
        if mismatch:
            other = str(not self._settings.latched).lower()
            return f"{self._topic}: {mismatch}; set the option latched: {other}"
        return f"no map has come on {self._topic} yet"
