from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterator
from itertools import chain

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from explore_bt.levelling import AttitudeFilter, LevelCloud, fault_of_cloud, level, virtual_scan
from explore_bt.testing.balancing_robot import BalancingRobot
from explore_bt.testing.scene3 import Prism, Scene3
from explore_bt.types import Imu, PointCloud, Pose2


def walls() -> Scene3:
    sides = [(-3.1, -2.1, 3.1, -2.0), (-3.1, 2.0, 3.1, 2.1), (-3.1, -2.1, -3.0, 2.1), (3.0, -2.1, 3.1, 2.1)]
    boxes = [np.array([(a, b), (c, b), (c, d), (a, d)]) for a, b, c, d in sides]
    return Scene3([Prism(box, 0.0, 2.5) for box in boxes])


def sweeps(base_height_m: float = 0.0) -> Iterator[tuple[LevelCloud, Pose2]]:
    """Noiseless sweeps of a robot that spins at 1.5 rad/s and swings by 9°, and where it stood."""
    robot = BalancingRobot(
        walls(), Pose2(0.5, -0.3, 0.4), pitch_rad=math.radians(9), roll_rad=math.radians(3), columns=300,
        range_noise_m=0.0, gyro_noise_rps=0.0, accelerometer_noise_mps2=0.0, gyro_bias_rps=0.0,
    )  # fmt: skip
    attitude = AttitudeFilter()
    for measurement in chain(robot.drive(0.0, 0.0, 0.5), robot.turn(4.0)):
        if isinstance(measurement, Imu):
            attitude.take_imu(measurement)
        elif isinstance(measurement, PointCloud):
            attitude.correct(np.zeros(2), 0.1)
            yield level(measurement, attitude, base_height_m, 5.0), robot.pose


def test_a_spinning_and_pitching_sweep_comes_out_level_and_straight() -> None:
    for cloud, pose in sweeps():
        there = pose.apply(cloud.ends[:, :2])
        to_wall = np.minimum(3.0 - np.abs(there[:, 0]), 2.0 - np.abs(there[:, 1]))
        is_floor = to_wall > 0.1
        assert is_floor.sum() > 200
        assert np.abs(cloud.ends[is_floor, 2]).max() < 0.01
        assert np.abs(to_wall[~is_floor & (cloud.ends[:, 2] > 0.1)]).max() < 0.02


def test_the_robots_way_is_put_in_by_its_speed() -> None:
    cloud, _ = next(sweeps())
    origins, ends = cloud.moved(np.array([0.5, -0.2]))
    way = cloud.times_s[:, None] * [0.5, -0.2]
    assert np.allclose(ends[:, :2] - cloud.ends[:, :2], way, atol=1e-6)
    assert np.allclose(origins[:, :2] - cloud.origins[:, :2], way, atol=1e-6)
    assert np.array_equal(ends[:, 2], cloud.ends[:, 2])


def test_base_height_lifts_everything() -> None:
    (low, _), (high, _) = next(sweeps()), next(sweeps(0.2))
    assert np.allclose(high.ends[:, 2] - low.ends[:, 2], 0.2, atol=1e-6)


def test_invalid_and_far_returns_are_dropped() -> None:
    points = np.array([[1, 0, 0], [np.nan, 0, 0], [0, 6, 0], [0, 2, 0], [np.inf, 0, 0]], np.float32)
    cloud = PointCloud(1.0, points, np.linspace(-0.1, 0.0, 5), np.eye(4))
    levelled = level(cloud, AttitudeFilter(), 0.0, 5.0)
    assert np.allclose(levelled.own, points[[0, 3]])
    assert np.allclose(levelled.times_s, cloud.times_s[[0, 3]])


def test_a_cloud_that_cannot_be_read_says_why() -> None:
    good = PointCloud(0.0, np.zeros((4, 3), np.float32), np.zeros(4), np.eye(4))
    assert fault_of_cloud(good) == ""
    assert "shape" in fault_of_cloud(dataclasses.replace(good, times_s=np.zeros(3)))
    assert "shape" in fault_of_cloud(dataclasses.replace(good, points=np.zeros((4, 4), np.float32)))
    assert "place" in fault_of_cloud(dataclasses.replace(good, T_base_sensor=np.full((4, 4), np.nan)))


@settings(deadline=None, max_examples=20)
@given(st.integers(0, 2**32 - 1))
def test_a_virtual_beam_is_the_nearest_return_of_its_direction_and_band(seed: int) -> None:
    rng = np.random.default_rng(seed)
    own = np.column_stack((rng.uniform(-4, 4, (400, 2)), rng.uniform(-0.2, 2.5, 400))).astype(np.float32)
    times = rng.uniform(-0.1, 0.0, 400)
    scan = virtual_scan(LevelCloud(0.0, times, own, own, own), 0.3, 2.0, 5.0)
    width = 2 * math.pi / 720
    exact = own.astype(np.float64)
    bins = np.minimum(np.floor((np.arctan2(exact[:, 1], exact[:, 0]) + np.pi) / width).astype(int), 719)
    for k in range(720):
        here = np.flatnonzero(bins == k)
        band = [i for i in here if 0.3 <= exact[i, 2] <= 2.0]
        if band:
            best = min(band, key=lambda i: float(np.hypot(*exact[i, :2])))
            assert math.isclose(float(scan.ranges_m[k]), float(np.hypot(*exact[best, :2])), rel_tol=1e-6)
            assert scan.times_s[k] == times[best]
            assert math.isclose(
                float(scan.angles_rad[k]), math.atan2(exact[best, 1], exact[best, 0]), abs_tol=1e-6
            )
        elif here.size:
            assert np.isposinf(scan.ranges_m[k])
        else:
            assert np.isnan(scan.ranges_m[k])
