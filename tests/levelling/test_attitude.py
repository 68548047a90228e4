from __future__ import annotations

import math

import numpy as np
import pytest

from explore_bt.levelling import AttitudeFilter
from explore_bt.types import Imu

STEP_S = 0.004
G = 9.81


def tilted(pitch: float, roll: float, along: float = 0.0) -> tuple[float, float, float]:
    """What an accelerometer feels on a body of that attitude that speeds up along its level x axis."""
    cp, sp, cr, sr = math.cos(pitch), math.sin(pitch), math.cos(roll), math.sin(roll)
    body = np.array([[cp, sp * sr, sp * cr], [0.0, cr, -sr], [-sp, cp * sr, cp * cr]])
    x, y, z = (np.array([along, 0.0, G]) @ body).tolist()
    return (x, y, z)


@pytest.mark.parametrize(("pitch", "roll"), [(0.0, 0.0), (0.16, 0.0), (-0.1, 0.05), (0.0, -0.2)])
def test_a_robot_at_rest_knows_how_it_leans_from_the_first_sample(pitch: float, roll: float) -> None:
    attitude = AttitudeFilter()
    level = attitude.take_imu(Imu(0.0, (0.0, 0.0, 0.0), tilted(pitch, roll)))
    assert np.allclose(attitude.tilt_rad, (pitch, roll), atol=1e-9)
    assert np.allclose(level.linear_acceleration_mps2, (0.0, 0.0, G), atol=1e-9)


def test_speeding_up_is_not_taken_for_a_slope_when_the_speed_is_known() -> None:
    attitude, speed = AttitudeFilter(), 0.0
    worst = 0.0
    for step in range(1500):
        along = 1.0 if step % 500 < 250 else -1.0
        speed += along * STEP_S if step else 0.0
        attitude.take_imu(Imu(step * STEP_S, (0.0, 0.0, 0.0), tilted(0.0, 0.0, along if step else 0.0)))
        if step % 25 == 0:
            attitude.correct(np.array([speed, 0.0]), 0.1)
        worst = max(worst, abs(attitude.tilt_rad[0]))
    plumb_line = math.atan(1.0 / G)
    assert worst < 0.05 * plumb_line


def test_without_any_speed_a_bounded_one_still_bounds_the_tilt() -> None:
    attitude, speed = AttitudeFilter(), 0.0
    for step in range(5000):
        along = 0.5 * math.cos(step * STEP_S)
        speed += along * STEP_S
        attitude.take_imu(Imu(step * STEP_S, (0.003, -0.004, 0.0), tilted(0.0, 0.0, along)))
        if step % 25 == 0:
            attitude.correct(np.zeros(2), 0.5)
    assert np.abs(attitude.tilt_rad).max() < math.radians(1.5)


def test_the_gyroscopes_bias_is_learnt() -> None:
    attitude = AttitudeFilter()
    for step in range(10_000):
        attitude.take_imu(Imu(step * STEP_S, (0.01, -0.006, 0.0), tilted(0.05, 0.0)))
        if step % 25 == 0:
            attitude.correct(np.zeros(2), 0.1)
    assert np.allclose(attitude.gyro_bias_rps[:2], (0.01, -0.006), atol=5e-4)
    assert np.allclose(attitude.tilt_rad, (0.05, 0.0), atol=2e-3)


def test_a_turn_is_levelled_so_that_its_rate_is_about_the_vertical() -> None:
    attitude, pitch = AttitudeFilter(), 0.15
    rates = (-1.5 * math.sin(pitch), 0.0, 1.5 * math.cos(pitch))
    for step in range(250):
        level = attitude.take_imu(Imu(step * STEP_S, rates, tilted(pitch, 0.0)))
    assert np.allclose(level.angular_velocity_rps, (0.0, 0.0, 1.5), atol=1e-6)
    assert np.allclose(attitude.tilt_rad, (pitch, 0.0), atol=1e-6)
    middle = attitude.between(np.array([0.0, 0.498, 0.5, 9.0]))
    yaws = np.arctan2(middle[:, 1, 0], middle[:, 0, 0])
    assert np.allclose(yaws[1:3], (1.5 * 0.498, 1.5 * 0.5), atol=1e-5)
    assert yaws[3] == pytest.approx(1.5 * 249 * STEP_S, abs=1e-5)


def test_a_sample_from_the_past_moves_nothing() -> None:
    attitude = AttitudeFilter()
    attitude.take_imu(Imu(1.0, (0.0, 0.0, 0.0), tilted(0.1, 0.0)))
    before = attitude.rotation
    attitude.take_imu(Imu(0.5, (3.0, 0.0, 0.0), tilted(0.1, 0.0)))
    assert np.array_equal(attitude.rotation, before)


def test_a_body_that_was_thrown_about_and_stands_again_knows_down_at_once_and_keeps_heading_and_bias() -> (
    None
):
    attitude = AttitudeFilter()
    still = tilted(0.0, 0.0)
    for step in range(500):
        attitude.take_imu(Imu(step * STEP_S, (0.0, 0.0, 0.2), still))
    heading = math.atan2(attitude.rotation[1, 0], attitude.rotation[0, 0])
    attitude.take_imu(Imu(501 * STEP_S, (0.0, 30.0, 0.0), (40.0, 5.0, -3.0)))
    bias = attitude.gyro_bias_rps
    attitude.stand()
    attitude.take_imu(Imu(2000 * STEP_S, (0.0, 0.0, 0.0), tilted(0.1, -0.05)))
    assert np.allclose(attitude.tilt_rad, (0.1, -0.05), atol=1e-9)
    now = math.atan2(attitude.rotation[1, 0], attitude.rotation[0, 0])
    assert abs(now - heading) < 0.05
    np.testing.assert_array_equal(attitude.gyro_bias_rps, bias)
