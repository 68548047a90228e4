"""SLAM from a 3D lidar: level, cut to a planar scan, register that, map in voxels."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from explore_bt.interfaces import RobotContext
from explore_bt.types import Health, Imu, PointCloud, Pose2
from explore_bt_slam.attitude import AttitudeFilter
from explore_bt_slam.graph_distance import relative_covariances
from explore_bt_slam.level_cloud import LevelCloud, fault_of_cloud, level
from explore_bt_slam.options import KissGtsamOptions
from explore_bt_slam.pipeline import Pipeline
from explore_bt_slam.sweep import Sweep
from explore_bt_slam.virtual_scan import virtual_scan
from explore_bt_slam.voxel_map import Heights
from explore_bt_slam.voxel_mapper import VoxelMapper

__all__ = ["CloudPipeline"]

_SPEED_SIGMA_MPS = 0.1
_SURE_M = 0.05
_RECENT = 12


class CloudPipeline(Pipeline):
    """The pipeline of planar scans, with everything before it that makes them level."""

    def __init__(self, options: KissGtsamOptions, context: RobotContext, revision: int = 0) -> None:
        super().__init__(options, context)
        heights = Heights(*options.obstacle_band, options.map_top)
        self.voxel_mapper = VoxelMapper(
            options.resolution, context.footprint_radius_m, heights, options.max_range, revision
        )
        self.mapper = self.voxel_mapper
        self.mapper.begin(self._start, Pose2.identity())
        self._options = options
        self._cloud: LevelCloud | None = None
        self._chosen = (-1, -1)
        self._speed_limit_mps = context.limits.speed_mps
        self._attitude = AttitudeFilter()

    def take_imu(self, imu: Imu) -> None:
        """A sample of the IMU, levelled before anything else hears it."""
        if np.isfinite((imu.stamp_s, *imu.angular_velocity_rps, *imu.linear_acceleration_mps2)).all():
            imu = self._attitude.take_imu(imu)
        super().take_imu(imu)

    def take_cloud(self, cloud: PointCloud) -> None:
        """One sweep, all the way to the map."""
        fault = fault_of_cloud(cloud)
        if fault:
            self.health.bad(cloud.stamp_s, fault)
            return
        options = self._options
        levelled = level(cloud, self._attitude, options.base_height, options.max_range)
        self._cloud = levelled
        self.take_scan(virtual_scan(levelled, *options.match_band, options.max_range))
        self._cloud = None
        if self.health.state[0] is Health.OK:
            self._attitude.correct(self.front.velocity_mps, _SPEED_SIGMA_MPS)
        else:
            self._attitude.correct(np.zeros(2), self._speed_limit_mps)

    def _draw(self, sweep: Sweep) -> None:  # noqa: ARG002  # the voxels take the whole cloud instead
        if self._cloud is None:
            return
        now = (self._keyframe, self.back.closures)
        if now != self._chosen:
            self._chosen = now
            self.voxel_mapper.choose_submap(self._keyframe, self._is_known(self._keyframe))
        self.voxel_mapper.see_cloud(self._cloud, self.front.velocity_mps, self._scan_pose)

    def _is_known(self, source: int) -> NDArray[np.bool_]:
        """(N,) bool: keyframes whose place relative to ``source`` is sure, or was measured just before."""
        covariances = relative_covariances(self.back.poses, self.back.edges, source)
        spread = np.sqrt(covariances[:, 0, 0] + covariances[:, 1, 1])
        return (spread <= _SURE_M) | (np.arange(spread.shape[0]) > source - _RECENT)
