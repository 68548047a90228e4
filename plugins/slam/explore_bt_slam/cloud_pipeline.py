"""SLAM from a 3D lidar: level, cut to a planar scan, register that, map in voxels."""

from __future__ import annotations

import numpy as np

from explore_bt.interfaces import RobotContext
from explore_bt.types import Health, Imu, PointCloud
from explore_bt_slam.attitude import AttitudeFilter
from explore_bt_slam.level_cloud import fault_of_cloud, level
from explore_bt_slam.options import KissGtsamOptions
from explore_bt_slam.pipeline import Pipeline
from explore_bt_slam.virtual_scan import virtual_scan

__all__ = ["CloudPipeline"]

_SPEED_SIGMA_MPS = 0.1


class CloudPipeline(Pipeline):
    """The pipeline of planar scans, with everything before it that makes them level."""

    def __init__(self, options: KissGtsamOptions, context: RobotContext) -> None:
        super().__init__(options, context)
        self._options = options
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
        if self.health.state[0] is Health.OK:
            self._attitude.correct(self.front.velocity_mps, _SPEED_SIGMA_MPS)
        else:
            self._attitude.correct(np.zeros(2), self._speed_limit_mps)
