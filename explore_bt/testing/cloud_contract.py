"""The part of the SLAM contract that feeds a 3D lidar on a body that swings."""

# ruff: noqa: D102  # the name of a test is its sentence
from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterable
from typing import ClassVar

import numpy as np
import pytest

from explore_bt.interfaces import RobotContext, Slam
from explore_bt.testing.balancing_robot import BalancingRobot
from explore_bt.testing.scene3 import Prism, Scene3
from explore_bt.testing.slam_room import Room, RoomTruth, ScriptedRobot
from explore_bt.types import FREE, Health, Measurement, PointCloud, Pose2

__all__ = ["CloudSlamContract"]

_START = Pose2(-0.6, -0.5, 0.0)


class CloudSlamContract:
    """Inherited by ``SlamContract``.

    Attributes:
        takes_clouds: whether the plugin maps from a ``PointCloud``; if not, it has to bear with them.
        cloud_tolerance_m: how far the estimate may be from the truth, with 2 cm of range noise.
    """

    takes_clouds: ClassVar[bool] = False
    cloud_tolerance_m: ClassVar[float] = 0.06

    def make(self) -> Slam:
        """A new plugin with its default options; ``setup`` is called by the suite."""
        raise NotImplementedError("write make() so that it returns your plugin")

    def test_a_swinging_drive_is_followed_by_clouds_or_they_are_ignored(self) -> None:
        slam, robot = self._swinging()
        before = slam.estimate().T_map_base
        _drive(slam, robot)
        after = slam.estimate()
        if not self.takes_clouds:
            assert after.T_map_base == before, "takes_clouds is False, and clouds moved the estimate"
            return
        off = after.T_map_base.distance_to(robot.pose)
        assert off < self.cloud_tolerance_m, f"after a swinging drive the estimate is {off:.3f} m off"
        assert after.health is Health.OK, f"health is {after.health}: {after.reason}"

    def test_a_swinging_lidar_makes_no_walls_of_the_floor(self) -> None:
        slam, robot = self._swinging()
        _drive(slam, robot)
        if not self.takes_clouds:
            return
        grid = slam.grid()
        occupied = grid.centers_of(np.argwhere(grid.occupied))
        assert len(occupied) > 100, f"only {len(occupied)} occupied cells in a walled room"
        far = Room.furnished().distance(occupied) > 3.0 * grid.resolution_m
        assert far.mean() < 0.01, f"{far.sum()} occupied cells stand on free floor"
        area = int((grid.cells == FREE).sum()) * grid.resolution_m**2
        assert area > 15.0, f"only {area:.1f} m² of 23 m² are free after looking around"

    @pytest.mark.parametrize("fault", ["all_nan", "empty", "backwards", "ragged"])
    def test_bad_clouds_are_survived_and_reported(self, fault: str) -> None:
        slam, robot = self._swinging()
        for measurement in robot.drive(0.0, 0.0, 0.5):
            slam.update(measurement)
        before = slam.estimate().T_map_base
        for measurement in robot.drive(0.0, 0.0, 0.4):
            slam.update(_spoilt(measurement, fault))
        estimate = slam.estimate()
        assert estimate.T_map_base.distance_to(before) < 0.2, (
            f"clouds that are {fault} moved a standing robot"
        )
        if self.takes_clouds:
            assert estimate.health is not Health.OK, f"clouds that are {fault}, and health says ok"
            assert estimate.reason, "health is not ok and gives no reason"

    def _swinging(self) -> tuple[Slam, BalancingRobot]:
        robot = BalancingRobot(_scene(Room.furnished()), _START, pitch_rad=math.radians(9.0), columns=450)
        slam = self.make()
        truth = RoomTruth(ScriptedRobot(Room.furnished(), _START))
        slam.setup(RobotContext(start=_START, footprint_radius_m=0.2, truth=truth))
        return slam, robot


def _drive(slam: Slam, robot: BalancingRobot) -> None:
    drives: list[Iterable[Measurement]] = [
        robot.drive(0.0, 0.0, 1.0),
        robot.go_to(0.8, 0.4),
        robot.turn(2.0 * math.pi),
        robot.go_to(-0.5, 0.5),
    ]
    for drive in drives:
        for measurement in drive:
            slam.update(measurement)


def _scene(room: Room) -> Scene3:
    """The room's segments as walls 2.5 m high, its pillars likewise."""
    prisms = []
    for x0, y0, x1, y1 in room.segments:
        across = np.array([y0 - y1, x1 - x0]) / math.hypot(x1 - x0, y1 - y0) * 0.01
        ends = np.array([(x0, y0), (x1, y1)])
        prisms.append(Prism(np.concatenate((ends - across, (ends + across)[::-1])), 0.0, 2.5))
    angles = np.linspace(0.0, 2.0 * math.pi, 24, endpoint=False)
    circle = np.column_stack((np.cos(angles), np.sin(angles)))
    prisms += [Prism(np.array([x, y]) + radius * circle, 0.0, 2.5) for x, y, radius in room.pillars]
    return Scene3(prisms)


def _spoilt(measurement: Measurement, fault: str) -> Measurement:
    if not isinstance(measurement, PointCloud):
        return measurement
    if fault == "all_nan":
        return dataclasses.replace(measurement, points=np.full_like(measurement.points, np.nan))
    if fault == "backwards":
        return dataclasses.replace(measurement, stamp_s=measurement.stamp_s - 10.0)
    if fault == "ragged":
        return dataclasses.replace(measurement, times_s=measurement.times_s[:-1])
    return dataclasses.replace(measurement, points=np.zeros((0, 3), np.float32), times_s=np.zeros(0))
