"""Bad data from a 3D lidar on a swinging body: right to 10 cm, or health says that it may not be."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterator

import numpy as np
import pytest
from explore_bt_slam import KissGtsam

from explore_bt.interfaces import RobotContext
from explore_bt.testing.balancing_robot import BalancingRobot
from explore_bt.testing.scene3 import Prism, Scene3
from explore_bt.types import Health, Measurement, PointCloud, Pose2
from tests.slam.faults import Fault, backwards, check, dropout, faulty


def box(x0: float, y0: float, x1: float, y1: float, low: float = 0.0, high: float = 2.5) -> Prism:
    return Prism(np.array([(x0, y0), (x1, y0), (x1, y1), (x0, y1)]), low, high)


def furnished() -> Scene3:
    """6 × 5 m with a sideboard, a table and a pillar."""
    walls = [box(-3, -2.6, 3, -2.5), box(-3, 2.5, 3, 2.6), box(-3.1, -2.5, -3, 2.5), box(3, -2.5, 3.1, 2.5)]
    things = [
        box(-1.0, 2.0, 0.6, 2.5, 0.0, 0.8),
        box(1.6, 1.0, 2.6, 1.8, 0.66, 0.7),
        box(1.5, -1.6, 1.8, -1.3),
    ]
    return Scene3([*walls, *things])


def invalid(cloud: PointCloud, rng: np.random.Generator) -> list[PointCloud]:
    """Three points in ten are NaN."""
    points = np.where(rng.random((len(cloud.points), 1)) < 0.3, np.float32(np.nan), cloud.points)
    return [dataclasses.replace(cloud, points=points)]


def twice(cloud: PointCloud, rng: np.random.Generator) -> list[PointCloud]:
    """Every cloud comes again, with the same stamp and other noise."""
    noise = rng.normal(0.0, 0.01, cloud.points.shape).astype(np.float32)
    return [cloud, dataclasses.replace(cloud, points=cloud.points + noise)]


def half_blocked(cloud: PointCloud, rng: np.random.Generator) -> list[PointCloud]:
    """Something stands before the left half of the lidar from the third second on."""
    blocked = (cloud.points[:, 1] > 0.0) & (cloud.stamp_s > 3.0)
    lengths = np.linalg.norm(cloud.points, axis=1, keepdims=True)
    with np.errstate(invalid="ignore"):
        near = cloud.points * np.float32(0.2) / lengths
    return [dataclasses.replace(cloud, points=np.where(blocked[:, None], near, cloud.points))]


def half_silent(cloud: PointCloud, rng: np.random.Generator) -> list[PointCloud]:
    """The same, but so near that nothing comes back."""
    blocked = (cloud.points[:, 1] > 0.0) & (cloud.stamp_s > 3.0)
    return [dataclasses.replace(cloud, points=np.where(blocked[:, None], np.float32(np.nan), cloud.points))]


def crowd(cloud: PointCloud, rng: np.random.Generator) -> list[PointCloud]:
    """Three people walk round the robot, in a fifth of the view."""
    azimuth = np.arctan2(cloud.points[:, 1], cloud.points[:, 0])
    points = cloud.points.copy()
    lengths = np.linalg.norm(points, axis=1)
    for k in range(3):
        ahead = 2.0 * math.pi * k / 3.0 + 0.5 * cloud.stamp_s
        near = 0.8 + 0.3 * math.sin(cloud.stamp_s + k)
        hidden = (np.abs(np.angle(np.exp(1j * (azimuth - ahead)))) < 0.21) & (lengths > near)
        points[hidden] *= (near / lengths[hidden])[:, None].astype(np.float32)
    return [dataclasses.replace(cloud, points=points)]


def course(robot: BalancingRobot) -> Iterator[Measurement]:
    for speed_mps, turn_rps, duration_s in (
        (0.0, 0.0, 1.0),
        (0.3, 0.25, 3.0),
        (0.2, 0.6, 3.0),
        (0.0, 1.5, 2.0),
    ):
        yield from robot.drive(speed_mps, turn_rps, duration_s)


def set_back(cloud: PointCloud, rng: np.random.Generator) -> list[PointCloud]:
    """From the fourth second on the lidar's clock is two seconds slow."""
    return [dataclasses.replace(cloud, stamp_s=cloud.stamp_s - 2.0) if cloud.stamp_s > 4.0 else cloud]


def ready(pitch_deg: float) -> tuple[BalancingRobot, KissGtsam]:
    swing = {"pitch_rad": math.radians(pitch_deg), "roll_rad": math.radians(0.2 * pitch_deg)}
    robot = BalancingRobot(furnished(), Pose2(-0.6, -0.5, 0.0), columns=300, **swing)
    slam = KissGtsam(KissGtsam.Options())
    slam.setup(RobotContext(start=robot.pose, footprint_radius_m=0.2))
    return robot, slam


@pytest.mark.parametrize("fault", [dropout, invalid, backwards, twice, half_blocked, half_silent, crowd])
def test_bad_clouds_cost_no_more_than_ten_centimetres_unless_health_says_so(fault: Fault) -> None:
    robot, slam = ready(pitch_deg=9.0)
    check(slam, robot, faulty(course(robot), fault))


@pytest.mark.parametrize("fault", [dropout, half_blocked, crowd])
def test_nor_do_they_without_an_imu_on_a_level_body(fault: Fault) -> None:
    robot, slam = ready(pitch_deg=0.0)
    check(slam, robot, (each for each in faulty(course(robot), fault) if isinstance(each, PointCloud)))


def test_a_lidar_whose_clock_is_set_back_is_told_of() -> None:
    robot, slam = ready(pitch_deg=0.0)
    unwell = []
    for measurement in faulty(course(robot), set_back):
        slam.update(measurement)
        if isinstance(measurement, PointCloud) and 4.1 < robot.time_s < 5.9:
            unwell.append(slam.estimate().health is not Health.OK)
    assert all(unwell)
    assert len(unwell) > 10


def test_clouds_of_nothing_but_nan_infinity_and_nonsense_do_no_harm() -> None:
    robot, slam = ready(pitch_deg=0.0)
    for number, measurement in enumerate(course(robot)):
        slam.update(measurement)
        if isinstance(measurement, PointCloud) and measurement.stamp_s > 2.0:
            bad = np.array([np.nan, np.inf, 1e30, 0.0], dtype=np.float32)[number % 4]
            points = np.full_like(measurement.points, bad)
            slam.update(dataclasses.replace(measurement, stamp_s=measurement.stamp_s + 0.01, points=points))
            slam.update(
                dataclasses.replace(
                    measurement,
                    stamp_s=measurement.stamp_s + 0.02,
                    points=points[:0],
                    times_s=measurement.times_s[:0],
                )
            )
    assert slam.estimate().T_map_base.distance_to(robot.pose) < 0.10
