from __future__ import annotations

import numpy as np
from explore_bt_slam.inertial import InertialFilter

from explore_bt.testing.slam_room import Room, ScriptedRobot
from explore_bt.types import Imu, Pose2, WheelOdometry

EXACT = np.diag([1e-3, 1e-3, 1e-3]) ** 2


def test_registration_teaches_speed_and_gyroscope_bias() -> None:
    robot = ScriptedRobot(Room.furnished(), Pose2(-1.0, 0.0, 0.0), gyro_bias_rps=0.015)
    inertial, last = InertialFilter(), robot.pose
    for measurement in robot.drive(0.3, 0.2, 5.0):
        if isinstance(measurement, Imu):
            inertial.take_imu(measurement)
            if round(measurement.stamp_s * 100) % 10 == 0:
                inertial.correct(last.between(robot.pose), EXACT)
                last = robot.pose
    assert np.allclose(inertial.velocity_mps, [0.3, 0.0], atol=0.02)
    for measurement in robot.drive(0.3, 0.2, 1.0):
        if isinstance(measurement, Imu):
            inertial.take_imu(measurement)
    predicted = last.compose(inertial.motion)
    assert predicted.distance_to(robot.pose) < 0.03
    assert abs(predicted.yaw_rad - robot.pose.yaw_rad) < 0.01


def test_the_accelerometer_notices_a_halt_that_no_scan_shows() -> None:
    robot = ScriptedRobot(Room.furnished(), Pose2(-1.0, 0.0, 0.0))
    inertial = InertialFilter()
    for speed_mps in (0.0, 0.4, 0.0):
        for measurement in robot.drive(speed_mps, 0.0, 0.5):
            if isinstance(measurement, Imu):
                inertial.take_imu(measurement)
        assert abs(float(inertial.velocity_mps[0]) - speed_mps) < 0.05
    assert abs(float(inertial.velocity_mps[0])) < 0.05


def test_without_imu_the_twist_stays_as_it_was() -> None:
    inertial = InertialFilter()
    inertial.advance_to(0.0)
    for step in range(1, 20):
        inertial.advance_to(0.1 * step)
        inertial.correct(Pose2(0.04, 0.0, 0.05), EXACT)
    inertial.advance_to(2.0)
    motion = inertial.motion
    assert np.allclose([motion.x, motion.y, motion.yaw_rad], [0.04, 0.0, 0.05], atol=0.004)


def test_uncertainty_grows_until_a_registration() -> None:
    inertial = InertialFilter()
    spreads = []
    for step in range(100):
        inertial.take_imu(Imu(0.01 * step, (0.0, 0.0, 0.1), (0.0, 0.0, 9.81)))
        spreads.append(float(np.trace(inertial.covariance)))
    assert np.all(np.diff(spreads) > 0.0)
    inertial.correct(inertial.motion, EXACT)
    assert np.trace(inertial.covariance) < 1e-5


def test_the_wheels_correct_the_speed_only() -> None:
    inertial = InertialFilter()
    for step in range(200):
        stamp_s = 0.05 * step
        inertial.take_imu(Imu(stamp_s, (0.0, 0.0, 0.0), (0.0, 0.0, 9.81)))
        inertial.take_odometry(WheelOdometry(stamp_s, Pose2(0.3 * stamp_s, 0.0, 0.0)))
    assert abs(float(inertial.velocity_mps[0]) - 0.3) < 0.05
    assert abs(inertial.motion.yaw_rad) < 0.05


def test_without_imu_the_wheels_are_the_prediction_whatever_the_clock_says() -> None:
    inertial, last = InertialFilter(), Pose2.identity()
    for stamp_s, yaw_rad in ((0.0, 0.0), (0.001, 0.3), (1.5, 0.1), (1.501, 0.9)):
        now = last.compose(Pose2(0.2, 0.0, yaw_rad))
        inertial.take_odometry(WheelOdometry(stamp_s, now))
        inertial.advance_to(stamp_s)
        if stamp_s > 0.0:
            assert np.allclose(inertial.motion.as_array(), last.between(now).as_array(), atol=1e-9)
            inertial.correct(inertial.motion, EXACT)
        last = now
    assert not inertial.is_blind


def test_a_stalled_odometry_link_is_not_taken_for_a_halt() -> None:
    inertial = InertialFilter()
    for step in range(12):
        stamp_s, heard = 0.2 * step, step if step < 5 else 4 if step < 9 else step
        inertial.take_odometry(WheelOdometry(stamp_s, Pose2(0.2 * heard, 0.0, 0.0)))
        inertial.advance_to(stamp_s)
        if step > 1:
            assert abs(inertial.motion.x - 0.2) < 0.01
        inertial.correct(Pose2(0.2 if step else 0.0, 0.0, 0.0), EXACT)
