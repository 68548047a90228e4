"""The ``kiss_gtsam`` plugin: kiss-icp odometry, SE(2) pose graph in gtsam, loops closed from the lidar."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from typing import ClassVar

from explore_bt.interfaces import API_VERSION, GraphShare, PluginOptions, RobotContext, Slam
from explore_bt.types import (
    Estimate,
    GridWindow,
    Imu,
    MapStructure,
    Measurement,
    OccupancyGrid,
    PointCloud,
    Pose2,
    RgbdFrame,
    Scan2D,
    Trajectory,
    WheelOdometry,
)
from explore_bt_slam.cloud_pipeline import CloudPipeline
from explore_bt_slam.cloud_warm_up import warm_up_clouds
from explore_bt_slam.kiss_share import KissShare
from explore_bt_slam.options import KissGtsamOptions
from explore_bt_slam.pipeline import Pipeline
from explore_bt_slam.storage import read_arrays
from explore_bt_slam.warm_up import warm_up

__all__ = ["KissGtsam"]


class KissGtsam(Slam):
    """Lidar and gyroscope in, pose and map out; wheels only where a mission says ``use_odometry``."""

    name = "kiss_gtsam"
    api_version = API_VERSION
    Options: ClassVar[type[PluginOptions]] = KissGtsamOptions

    def __init__(self, options: PluginOptions) -> None:
        super().__init__(options)
        self._settings = KissGtsamOptions.model_validate(options.model_dump())
        self._start: Pose2 | None = None
        self._context = RobotContext()
        self._pipeline = self._new_pipeline(self._context)

    def setup(self, context: RobotContext) -> None:
        """Begin at ``context.start``; compiles the kernels on first use (some seconds, then cached)."""
        self._start, self._context = context.start, context
        warm_up(self._new_pipeline(context))
        warm_up_clouds(self._new_cloud_pipeline())
        self._pipeline = self._new_pipeline(context)

    def update(self, measurement: Measurement) -> None:
        """Take one measurement; see ``Pipeline`` for the steps."""
        if isinstance(measurement, Imu):
            self._pipeline.take_imu(measurement)
        elif isinstance(measurement, WheelOdometry):
            self._pipeline.take_odometry(measurement)
        elif isinstance(measurement, RgbdFrame):
            self._pipeline.take_image(measurement)
        elif isinstance(measurement, Scan2D) and not isinstance(self._pipeline, CloudPipeline):
            begun = time.perf_counter()
            self._pipeline.take_scan(measurement)
            self._pipeline.journal.took(time.perf_counter() - begun)
        elif isinstance(measurement, PointCloud):
            self._take_cloud(measurement)

    def estimate(self) -> Estimate:
        """The pose now, carried from the last scan to the last IMU sample by the gyroscope."""
        return self._pipeline.estimate()

    def grid(self) -> OccupancyGrid:
        """The map; copied only when asked for and changed."""
        return self._pipeline.mapper.grid()

    def changed_since(self, revision: int) -> GridWindow | None:
        """Window of cells that may differ from that revision."""
        return self._pipeline.mapper.changed_since(revision)

    def forget_near(self, position: tuple[float, float], radius_m: float) -> bool:
        """Until the next sweep that sees them."""
        return self._pipeline.mapper.forget_near(position, radius_m)

    def trajectory(self) -> Trajectory:
        """One pose per scan, moved along with the graph."""
        return self._pipeline.journal.trajectory(self._pipeline.back.poses)

    def figures(self) -> Mapping[str, float]:
        """``scans``, ``keyframes``, ``loop_closures``, ``ms_per_scan_median``, ``ms_per_scan_p99``.

        With a 3D lidar also ``submaps`` and ``voxel_mb``, the memory of their voxels.
        """
        return {
            **self._pipeline.figures(),
            "keyframes": float(len(self._pipeline.back.keyframes)),
            "loop_closures": float(self._pipeline.back.closures),
        }

    def structure(self) -> MapStructure:
        """The pose graph, and the voxels if the lidar is a 3D one."""
        return self._pipeline.structure()

    def graph_share(self) -> GraphShare:
        """Keyframes and graph for team mates, and theirs in one's own graph."""
        return KissShare(lambda: self._pipeline.back)

    def save(self, folder: Path) -> None:
        """One file, ``slam.npz``: keyframes, graph, kept sweeps, trajectory."""
        self._pipeline.frozen().write(folder, self.name, self._settings.resolution)

    def begin_save(self, folder: Path, before: Path | None) -> Callable[[], None]:
        """``slam.npz``, and keyframes and sweeps apart, of which only the new ones are written."""
        frozen = self._pipeline.frozen()
        return partial(frozen.write_quickly, folder, self.name, self._settings.resolution, before)

    def load(self, folder: Path) -> None:
        """Go on in a saved map, at ``context.start``, or where the saved trajectory ended if None."""
        arrays = read_arrays(folder, self.name, self._settings.resolution)
        if "voxel_pool" in arrays:
            self._pipeline = self._new_cloud_pipeline()
        self._pipeline.restore(arrays, self._start)
        if self._context.resumed is not None:
            self._pipeline.go_on(arrays)

    def pick_up(self) -> None:
        """The next scan is looked for about the place, whichever way the robot has been turned."""
        self._pipeline.pick_up()

    def _take_cloud(self, cloud: PointCloud) -> None:
        """The first lidar that speaks, planar or 3D, is the one that is listened to."""
        begun = time.perf_counter()
        if not isinstance(self._pipeline, CloudPipeline):
            if self._pipeline.has_begun:
                return
            self._pipeline = self._new_cloud_pipeline()
        self._pipeline.take_cloud(cloud)
        self._pipeline.journal.took(time.perf_counter() - begun)

    def _new_cloud_pipeline(self) -> CloudPipeline:
        return CloudPipeline(self._settings, self._context, self._pipeline.mapper.revision)

    def _new_pipeline(self, context: RobotContext) -> Pipeline:
        return Pipeline(self._settings, context)
