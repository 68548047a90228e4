"""The planar scan that is driven by: a planar lidar's own, or made of a 3D lidar's sweeps."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from explore_bt.levelling import AttitudeFilter, fault_of_cloud, level, virtual_scan
from explore_bt.types import BodyShape, Imu, Measurement, PointCloud, Scan2D, Twist2

__all__ = ["Lookout"]

_USUAL_RANGE_M = 5.0
"""Of a 3D lidar that does not say how far it sees: beyond, its returns are too far apart to drive by."""
_RISE = math.tan(math.radians(1.0))
"""By so much for every metre away the floor may seem to rise: an error of the attitude of 1°."""
_SURFACE_M = 0.06
"""Three standard deviations of a range: of sixteen returns of a jamb the nearest is 4 cm too near."""
_DIRECTIONS = 360
"""As many as planar lidars have: people are told by what four neighbouring beams saw through."""
_SPEED_SIGMA_MPS = 0.15
"""How far a body strays from the speed it is told."""


class Lookout:
    """Keeps the newest scan.

    Of a 3D sweep it keeps in every direction the nearest return that the body could run into: higher than
    what it drives over, lower than its own height. So table tops and overhangs count, and legs. Once a planar
    lidar has spoken, sweeps are left alone: somebody mounted it for this.

    Attributes:
        scan: the newest; None before the first.
    """

    def __init__(self, shape: BodyShape | None = None) -> None:
        self.scan: Scan2D | None = None
        self._shape = shape or BodyShape()
        self._attitude = AttitudeFilter()
        self._is_planar = False

    def hear(self, measurement: Measurement, twist_at: Callable[[float], Twist2]) -> None:
        """Take one measurement, in time order.

        Args:
            measurement: of any kind.
            twist_at: of the robot at a time, as it was told: it keeps a speed from being taken for a slope.
        """
        if isinstance(measurement, Scan2D):
            self.scan, self._is_planar = measurement, True
        elif isinstance(measurement, Imu):
            self._feel(measurement)
        elif isinstance(measurement, PointCloud) and not self._is_planar:
            self._look(measurement, twist_at(measurement.stamp_s))

    @property
    def range_m(self) -> float:
        """How far the lidar sees."""
        return self.scan.range_max_m if self.scan else _USUAL_RANGE_M

    def forget(self) -> None:
        """No scan of before is worth anything now."""
        self.scan = None

    def _feel(self, imu: Imu) -> None:
        felt = (*imu.angular_velocity_rps, *imu.linear_acceleration_mps2)
        if not self._is_planar and np.isfinite(felt).all():
            self._attitude.take_imu(imu)

    def _look(self, cloud: PointCloud, twist: Twist2) -> None:
        if fault_of_cloud(cloud):
            return  # the scan grows old, which is noticed
        shape = self._shape
        reach_m = cloud.range_max_m if math.isfinite(cloud.range_max_m) else _USUAL_RANGE_M
        levelled = level(cloud, self._attitude, shape.base_height_m, reach_m)
        self.scan = virtual_scan(
            levelled,
            shape.step_m,
            shape.height_m,
            reach_m,
            rise=_RISE,
            surface_m=_SURFACE_M,
            bins=_DIRECTIONS,
        )
        self._attitude.correct(np.array([twist.linear_mps, 0.0]), _SPEED_SIGMA_MPS)
