"""Bad data: the pose stays within 10 cm, or health says that it may not."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterator

import numpy as np
import pytest
from explore_bt_slam import KissGtsam

from explore_bt.interfaces import RobotContext
from explore_bt.testing.slam_room import Room, ScriptedRobot
from explore_bt.types import Health, Measurement, Pose2, Scan2D, wrap_angle
from tests.slam.faults import Fault, backwards, check, dropout, faulty


def invalid(scan: Scan2D, rng: np.random.Generator) -> list[Scan2D]:
    """Three beams in ten are NaN."""
    ranges = np.where(rng.random(scan.ranges_m.shape[0]) < 0.3, np.nan, scan.ranges_m)
    return [dataclasses.replace(scan, ranges_m=ranges.astype(np.float32))]


def twice(scan: Scan2D, rng: np.random.Generator) -> list[Scan2D]:
    """Every scan comes again, with the same stamp and other noise."""
    noise = rng.normal(0.0, 0.01, scan.ranges_m.shape[0])
    return [scan, dataclasses.replace(scan, ranges_m=(scan.ranges_m + noise).astype(np.float32))]


def half_blocked(scan: Scan2D, rng: np.random.Generator) -> list[Scan2D]:
    """Something stands before the left half of the lidar from the third second on."""
    is_blocked = (scan.angles_rad > 0.0) & (scan.stamp_s > 3.0)
    return [dataclasses.replace(scan, ranges_m=np.where(is_blocked, 0.2, scan.ranges_m).astype(np.float32))]


def crowd(scan: Scan2D, rng: np.random.Generator) -> list[Scan2D]:
    """Three people walk round the robot, in a fifth of the view."""
    ranges = scan.ranges_m.copy()
    for k in range(3):
        ahead = 2.0 * math.pi * k / 3.0 + 0.5 * scan.stamp_s
        turn = np.array([abs(wrap_angle(float(angle) - ahead)) for angle in scan.angles_rad])
        near = 0.8 + 0.3 * math.sin(scan.stamp_s + k)
        ranges = np.where(turn < 0.21, np.minimum(ranges, near), ranges)
    return [dataclasses.replace(scan, ranges_m=ranges.astype(np.float32))]


def course(robot: ScriptedRobot) -> Iterator[Measurement]:
    for speed_mps, turn_rps, duration_s in (
        (0.3, 0.25, 4.0),
        (0.2, 0.6, 4.0),
        (0.3, 0.0, 2.0),
        (0.0, 0.8, 3.0),
    ):
        yield from robot.drive(speed_mps, turn_rps, duration_s)


@pytest.mark.parametrize("with_imu", [True, False])
@pytest.mark.parametrize("fault", [dropout, invalid, backwards, twice, half_blocked, crowd])
def test_bad_data_costs_no_more_than_ten_centimetres_unless_health_says_so(
    fault: Fault, with_imu: bool
) -> None:
    robot = ScriptedRobot(Room.furnished(), Pose2(-0.6, -0.5, 0.0))
    slam = KissGtsam(KissGtsam.Options())
    slam.setup(RobotContext(start=robot.pose))
    measured = faulty(course(robot), fault)
    check(slam, robot, (each for each in measured if with_imu or isinstance(each, Scan2D)))


def test_a_turn_that_the_gyroscope_did_not_feel_is_not_believed() -> None:
    """Somebody twists the lidar on its mount by 7°: the map then fits best with the robot turned."""
    robot = ScriptedRobot(Room.furnished(), Pose2(-0.6, -0.5, 0.0))
    slam = KissGtsam(KissGtsam.Options())
    slam.setup(RobotContext(start=robot.pose))
    for measurement in course(robot):
        twisted = measurement
        if isinstance(measurement, Scan2D) and measurement.stamp_s > 4.0:
            twisted = dataclasses.replace(measurement, angles_rad=measurement.angles_rad - 0.12)
        slam.update(twisted)
        if isinstance(measurement, Scan2D):
            estimate = slam.estimate()
            turned = abs(wrap_angle(estimate.T_map_base.yaw_rad - robot.pose.yaw_rad))
            assert turned < 0.05 or estimate.health is not Health.OK, measurement.stamp_s


@pytest.mark.parametrize("with_imu", [True, False])
def test_a_clock_set_back_for_good_is_lost_within_a_second_and_then_says_so(with_imu: bool) -> None:
    robot = ScriptedRobot(Room.furnished(), Pose2(-0.6, -0.5, 0.0))
    slam = KissGtsam(KissGtsam.Options())
    slam.setup(RobotContext(start=robot.pose))
    for measurement in robot.drive(0.2, 0.3, 8.0):
        if isinstance(measurement, Scan2D):
            late_s = 60.0 if measurement.stamp_s > 4.0 else 0.0
            slam.update(dataclasses.replace(measurement, stamp_s=measurement.stamp_s - late_s))
            estimate = slam.estimate()
            off_m = estimate.T_map_base.distance_to(robot.pose)
            assert off_m < 0.10 or estimate.health is not Health.OK, measurement.stamp_s
        elif with_imu:
            slam.update(measurement)
    assert slam.estimate().health is Health.LOST
