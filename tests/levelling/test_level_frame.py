import math

import numpy as np
import pytest

from explore_bt.levelling import AttitudeFilter, level_frame
from explore_bt.types import Imu, RgbdFrame

OPTICAL = np.array([[0.0, 0.0, 1.0, 0.1], [-1.0, 0.0, 0.0, 0.0], [0.0, -1.0, 0.0, 0.5], [0.0, 0.0, 0.0, 1.0]])


def frame(stamp_s: float) -> RgbdFrame:
    return RgbdFrame(
        stamp_s, np.zeros((4, 6), np.uint8), np.ones((4, 6), np.float32), 5.0, 5.0, 2.5, 1.5, OPTICAL
    )


def resting(pitch: float, roll: float, turn_rps: float = 0.0) -> AttitudeFilter:
    """A filter that has felt gravity in a body that leans, and turns about the vertical for 2 s."""
    up = np.array([-math.sin(pitch), math.cos(pitch) * math.sin(roll), math.cos(pitch) * math.cos(roll)])
    attitude = AttitudeFilter()
    for k in range(401):
        attitude.take_imu(Imu(k / 200.0, tuple((turn_rps * up).tolist()), tuple((9.81 * up).tolist())))
    return attitude


def test_a_point_before_a_leaning_camera_gets_the_height_that_it_has() -> None:
    pitch, roll = 0.08, -0.05
    rolled = np.array([[1, 0, 0], [0, math.cos(roll), -math.sin(roll)], [0, math.sin(roll), math.cos(roll)]])
    pitched = np.array(
        [[math.cos(pitch), 0, math.sin(pitch)], [0, 1, 0], [-math.sin(pitch), 0, math.cos(pitch)]]
    )
    level = level_frame(frame(2.0), resting(pitch, roll), 0.3)
    for point in ((0.0, 0.0, 3.0, 1.0), (1.0, -0.5, 2.0, 1.0)):
        seen = level.T_base_sensor @ point
        assert seen[:3] == pytest.approx(pitched @ rolled @ (OPTICAL @ point)[:3] + (0.0, 0.0, 0.3), abs=1e-3)


def test_turning_about_the_vertical_changes_nothing() -> None:
    level = level_frame(frame(2.0), resting(0.0, 0.0, 0.7), 0.0)
    assert level.T_base_sensor == pytest.approx(OPTICAL, abs=1e-6)


def test_pixels_and_intrinsics_stay() -> None:
    before = frame(1.0)
    level = level_frame(before, resting(0.1, 0.0), 0.0)
    assert level.image is before.image
    assert level.depth_m is before.depth_m
    assert (level.fx, level.fy, level.cx, level.cy) == (5.0, 5.0, 2.5, 1.5)
