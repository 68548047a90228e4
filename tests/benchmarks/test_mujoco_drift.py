"""The led body of benchmarks/mujoco_drift.py moves as its IMU says."""

import numpy as np
import pytest

pytest.importorskip("mujoco")

from explore_bt_drivers.mujoco.body.build import WHEEL_RADIUS_M
from mujoco_drift import STEP_S, legs, ring, rows
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation


@pytest.fixture(name="states", scope="module")
def _states() -> NDArray[np.float64]:
    return rows()


def turned(states: NDArray[np.float64]) -> Rotation:
    return Rotation.from_quat(np.roll(states[:, 3:7], -1, axis=1))


def axle(states: NDArray[np.float64]) -> NDArray[np.float64]:
    return states[:, :3] + turned(states).apply([0.0, 0.0, WHEEL_RADIUS_M])


def test_the_course_takes_over_ten_minutes_and_ends_where_its_legs_end(states) -> None:
    assert len(states) * STEP_S > 600.0
    x = y = yaw = 0.0
    for ahead_m, turn_rad in legs():
        x, y, yaw = x + ahead_m * np.cos(yaw), y + ahead_m * np.sin(yaw), yaw + turn_rad
    assert axle(states)[-1] == pytest.approx((x, y, WHEEL_RADIUS_M), abs=0.01)


def test_the_gyroscope_feels_the_body_turn(states) -> None:
    part = states[34_000:38_000]  # with the first turn
    whole = turned(part[:1])[0]
    for spin in part[1:, 7:10]:
        whole = whole * Rotation.from_rotvec(spin * STEP_S)
    assert (whole.inv() * turned(part[-1:])[0]).magnitude() < 1e-3


def test_the_accelerometer_feels_the_axle_speed_up_and_the_floor_below(states) -> None:
    part = states[1_000:80_000]
    force = turned(part).apply(part[:, 10:13]) - (0.0, 0.0, 9.81)
    velocity = np.gradient(axle(part), STEP_S, axis=0)
    gained = np.cumsum(force, axis=0) * STEP_S
    assert np.abs(gained - (velocity - velocity[0])).max() < 0.02
    assert np.abs(force[:, 2]).max() < 1e-6


def test_quaternions_are_whole_and_do_not_jump(states) -> None:
    assert np.linalg.norm(states[:, 3:7], axis=1) == pytest.approx(1.0)
    assert ((states[1:, 3:7] * states[:-1, 3:7]).sum(axis=1) > 0.999).all()


def test_only_the_furnished_ring_has_cabinets_along_its_first_side() -> None:
    assert ring("furnished").count("cabinet") == ring("plain").count("cabinet") + 4
