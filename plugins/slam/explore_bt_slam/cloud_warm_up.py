"""Run the kernels of 3D lidars once, so that none compiles while the robot drives."""

from __future__ import annotations

import numpy as np

from explore_bt.types import Imu, PointCloud
from explore_bt_slam.cloud_pipeline import CloudPipeline

__all__ = ["warm_up_clouds"]


def warm_up_clouds(pipeline: CloudPipeline) -> None:
    """Stand a throw-away pipeline in a square room for three sweeps."""
    for step in range(3):
        for tick in range(10):
            stamp_s = 0.1 * step + 0.01 * tick
            pipeline.take_imu(Imu(stamp_s, (0.0, 0.0, 0.0), (0.0, 0.0, 9.81)))
        pipeline.take_cloud(_room(0.1 * (step + 1)))
    pipeline.structure()


def _room(stamp_s: float) -> PointCloud:
    """Four walls 2 m away, at two heights."""
    angles = np.repeat(np.linspace(-np.pi, np.pi, 180, endpoint=False), 2)
    cos, sin = np.cos(angles), np.sin(angles)
    ranges = 2.0 / np.maximum(np.abs(cos), np.abs(sin))
    heights = np.tile([0.5, 0.8], 180)
    points = np.column_stack((ranges * cos, ranges * sin, heights)).astype(np.float32)
    return PointCloud(stamp_s, points, np.repeat(np.linspace(-0.1, 0.0, 180), 2), np.eye(4))
