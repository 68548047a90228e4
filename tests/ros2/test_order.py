"""Measurements of several topics find their order; odometry does not jump."""

from __future__ import annotations

from tests.ros2 import ros  # isort: skip  # noqa: F401

import numpy as np
from explore_bt_ros2.senses.odometry import SmoothOdometry
from explore_bt_ros2.senses.order import Order
from hypothesis import given
from hypothesis import strategies as st

from explore_bt.types import Imu, MotionLimits, Pose2, Scan2D, WheelOdometry


def imu(stamp_s):
    return Imu(stamp_s, (0.0, 0.0, 0.0), (0.0, 0.0, 9.8))


def scan(stamp_s):
    return Scan2D(stamp_s, np.zeros(1), np.ones(1, dtype=np.float32), np.zeros(1), 0.1, 5.0)


def passed_on(scan_lag_s, period_s=0.05, duration_s=3.0):
    """What a control loop is given by a 100 Hz IMU without delay and a 10 Hz lidar with one."""
    coming = [(0.01 * n, imu(0.01 * n)) for n in range(1, round(100 * duration_s))]
    coming += [(0.1 * n + scan_lag_s, scan(0.1 * n)) for n in range(1, round(10 * duration_s))]
    coming.sort(key=lambda each: each[0])
    order, out = Order(), []
    for step in range(1, round(duration_s / period_s)):
        now_s = step * period_s
        due = [(measured, arrived_s) for arrived_s, measured in coming if arrived_s <= now_s]
        coming = coming[len(due) :]
        out += [(each, now_s) for each in order.sort(due, now_s)]
    return out


@given(st.floats(0.0, 0.14))
def test_stamps_never_go_back_and_a_usual_delay_costs_none_of_them_its_stamp(lag_s):
    out = passed_on(lag_s)
    stamps = [each.stamp_s for each, _ in out]
    assert stamps == sorted(stamps)
    later = [each for each, now_s in out if now_s > 1.0 and isinstance(each, Scan2D)]
    assert len(later) > 10
    for each in later:  # multiples of 0.1 s, as measured
        assert abs(each.stamp_s * 10 - round(each.stamp_s * 10)) < 1e-6


@given(st.floats(0.0, 0.14))
def test_a_scan_never_waits(lag_s):
    for each, now_s in passed_on(lag_s):
        if isinstance(each, Scan2D):
            assert now_s - each.stamp_s <= lag_s + 0.05 + 1e-6


def test_a_robot_without_scans_still_has_its_gyroscope():
    order = Order()
    assert [each.stamp_s for each in order.sort([(imu(1.0), 1.0)], 1.0)] == [1.0]


@given(st.floats(-5.0, 5.0), st.floats(-3.0, 3.0))
def test_odometry_that_is_set_anew_goes_on_from_where_it_was(x, yaw):
    smooth, told = SmoothOdometry(MotionLimits()), []
    set_anew = Pose2(x, 0.0, yaw)
    for n in range(40):
        pose = Pose2(0.02 * n, 0.0, 0.0)
        pose = set_anew.compose(pose) if n >= 20 else pose
        measured, words = smooth.take(WheelOdometry(0.05 * n, pose))
        told += [words] if words else []
        assert abs(measured.T_odom_base.x - 0.02 * n) < 0.8
        assert measured.T_odom_base.distance_to(Pose2(0.02 * n, 0, 0)) < 0.8
    assert len(told) == (1 if abs(x) > 0.4 or abs(yaw) > 0.7 else len(told))


def test_a_jump_is_told_in_metres_and_radians():
    smooth = SmoothOdometry(MotionLimits())
    smooth.take(WheelOdometry(0.0, Pose2.identity()))
    _, words = smooth.take(WheelOdometry(0.05, Pose2(2.0, 0.0, 0.5)))
    assert words == "it jumped by 2.00 m and 0.50 rad in 0.05 s"
