"""SLAM from a 3D lidar: level, cut to a planar scan, register that, map in voxels."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from explore_bt.errors import PluginError
from explore_bt.interfaces import RobotContext
from explore_bt.levelling import AttitudeFilter, LevelCloud, fault_of_cloud, level, level_frame, virtual_scan
from explore_bt.types import BodyShape, Health, Imu, MapStructure, PointCloud, Pose2, RgbdFrame, Voxels
from explore_bt_slam.front_end import Registered
from explore_bt_slam.graph_distance import relative_covariances
from explore_bt_slam.options import KissGtsamOptions
from explore_bt_slam.pipeline import Pipeline
from explore_bt_slam.sweep import Sweep
from explore_bt_slam.voxel_map import Heights
from explore_bt_slam.voxel_mapper import VoxelMapper

__all__ = ["CloudPipeline"]

_SPEED_SIGMA_MPS = 0.1
_SEEN_FOR_S = 1.5
"""So long is a speed that the camera has seen good for telling tilt from acceleration."""
_SURE_M = 0.05
_KNOWN_OVERLAP = 0.8
_SAME_PLACE = 0.6


class CloudPipeline(Pipeline):
    """The pipeline of planar scans, with everything before it that makes them level."""

    def __init__(self, options: KissGtsamOptions, context: RobotContext, revision: int = 0) -> None:
        super().__init__(options, context)
        heights = _heights(options, context.shape)
        self._base_m = context.shape.base_height_m if options.base_height is None else options.base_height
        self.voxel_mapper = VoxelMapper(
            options.resolution,
            context.footprint_radius_m,
            heights,
            options.max_range,
            revision,
            options.clear_start,
        )
        self.mapper = self.voxel_mapper
        self.mapper.begin(self._start, Pose2.identity())
        self._options = options
        self._cloud: LevelCloud | None = None
        self._chosen = (-1, -1)
        self._known_at = (-1, 0, 0)
        self._known_now = np.zeros(0, np.bool_)
        self._speed_limit_mps = context.limits.speed_mps
        self._attitude = AttitudeFilter()

    def take_imu(self, imu: Imu) -> None:
        """A sample of the IMU, levelled before anything else hears it."""
        if np.isfinite((imu.stamp_s, *imu.angular_velocity_rps, *imu.linear_acceleration_mps2)).all():
            imu = self._attitude.take_imu(imu)
        super().take_imu(imu)

    def take_image(self, frame: RgbdFrame) -> None:
        """An image, from a camera that leans with the body."""
        super().take_image(level_frame(frame, self._attitude, self._base_m))

    def take_cloud(self, cloud: PointCloud) -> None:
        """One sweep, all the way to the map."""
        fault = fault_of_cloud(cloud)
        if fault:
            self.health.bad(cloud.stamp_s, fault)
            return
        options = self._options
        levelled = level(cloud, self._attitude, self._base_m, options.max_range)
        self._cloud = levelled
        self.take_scan(virtual_scan(levelled, options.match_low, options.match_high, options.max_range))
        self._cloud = None
        is_seen = cloud.stamp_s - self.seen_s <= _SEEN_FOR_S
        if self.health.state[0] is Health.OK or is_seen:
            self._attitude.correct(self.front.velocity_mps, _SPEED_SIGMA_MPS)
        else:
            self._attitude.correct(np.zeros(2), self._speed_limit_mps)

    def pick_up(self) -> None:
        """What the IMU told before is no word on which way is down now."""
        super().pick_up()
        self._attitude.stand()

    def figures(self) -> dict[str, float]:
        """Also submaps, and megabytes of voxels."""
        voxels = self.voxel_mapper.voxels
        own = {"submaps": float(len(voxels.submaps)), "voxel_mb": voxels.memory_bytes / 1e6}
        return {**super().figures(), **own}

    def structure(self) -> MapStructure:
        """Voxels and pose graph."""
        voxels = self.voxel_mapper.voxels
        keys, log_odds = voxels.voxels(self.voxel_mapper.submap_poses)
        return MapStructure(Voxels(keys, log_odds, voxels.cell_m), super().structure().graph)

    def _make_keyframe(self, registered: Registered) -> None:
        """Where a keyframe already stands, and surely so, the robot goes on from that one.

        So the graph grows with the area and not with time. A scan sees all round: headings do not matter.
        """
        old = self._stands_here(registered)
        if old is None:
            super()._make_keyframe(registered)
        elif old != self._keyframe:
            self._relative = self.back.pose(old).between(self._scan_pose)
            self._keyframe = old
            if self.camera is not None:
                self.camera.forget()  # what it has seen belongs to the keyframe before
            self.front.relocate(*self.back.surroundings(old))

    def _stands_here(self, registered: Registered) -> int | None:
        """The nearest keyframe, if it is near, its place is sure, and the map about it knows the scan."""
        if registered.weakness or registered.overlap < _KNOWN_OVERLAP:
            return None
        poses, here = self.back.poses, self._scan_pose
        distance = np.hypot(poses[:, 0] - here.x, poses[:, 1] - here.y)
        near = np.flatnonzero(distance <= _SAME_PLACE * self._options.keyframe_distance)
        sure = near[self._known()[near]]
        return int(sure[np.argmin(distance[sure])]) if sure.size else None

    def _draw(self, sweep: Sweep) -> None:  # noqa: ARG002  # the voxels take the whole cloud instead
        if self._cloud is None:
            return
        now = (self._keyframe, self.back.closures)
        if now != self._chosen:
            self._chosen = now
            self.voxel_mapper.choose_submap(self._keyframe, self._known())
        self.voxel_mapper.see_cloud(self._cloud, self.front.velocity_mps, self._scan_pose)

    def _known(self) -> NDArray[np.bool_]:
        """(N,) bool: keyframes whose place relative to the present one is sure, along the graph."""
        state = (self._keyframe, len(self.back.keyframes), self.back.closures)
        if self._known_at != state:
            covariances = relative_covariances(self.back.poses, self.back.edges, self._keyframe)
            spread = np.sqrt(covariances[:, 0, 0] + covariances[:, 1, 1])
            self._known_at, self._known_now = state, spread <= _SURE_M
        return self._known_now


def _heights(options: KissGtsamOptions, shape: BodyShape) -> Heights:
    """The bands; a robot is as high as the options say, else as its driver says.

    Raises:
        PluginError: it would not reach above the floor.
    """
    robot_m = shape.height_m if options.robot_height is None else options.robot_height
    if robot_m <= options.floor_height:
        raise PluginError(
            f"kiss_gtsam: floor_height is {options.floor_height:g} m and the robot {robot_m:g} m high, as its"
            " driver says; lower floor_height, or say robot_height"
        )
    return Heights(options.floor_height, robot_m, max(options.map_height, robot_m))
