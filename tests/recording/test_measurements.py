from __future__ import annotations

import base64
import json
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from explore_bt.recording import decode_measurements
from explore_bt.recording.measurements import measurements_message
from explore_bt.types import Imu, PointCloud, Pose2, Scan2D, WheelOdometry

numbers = st.floats(-1e3, 1e3)
three = st.tuples(numbers, numbers, numbers)
ranges = st.one_of(st.floats(0.0, 30.0), st.just(math.nan), st.just(math.inf))


@st.composite
def scans(draw):
    count = draw(st.integers(0, 20))
    found = np.array(draw(st.lists(ranges, min_size=count, max_size=count)), dtype=np.float32)
    angles = np.linspace(-1.0, draw(st.floats(0.0, 3.0)), count)
    if draw(st.booleans()):
        angles = angles**3  # not evenly spaced
    mounting = Pose2(*draw(three))
    limits = (0.05, draw(st.sampled_from([5.0, 30.0, math.inf])))
    return Scan2D(draw(numbers), angles, found, np.linspace(-0.1, 0.0, count), *limits, "laser", mounting)


@st.composite
def clouds(draw):
    points = np.array(draw(st.lists(st.tuples(*[st.floats(-20, 20)] * 3), max_size=9)), dtype=np.float32)
    points = points.reshape(-1, 3)
    points[: draw(st.integers(0, 2))] = np.nan
    return PointCloud(draw(numbers), points, np.linspace(-0.1, 0.0, len(points)), np.eye(4))


imus = st.builds(Imu, numbers, three, three)
odometries = st.builds(WheelOdometry, numbers, st.builds(Pose2, numbers, numbers, numbers))


def there_and_back(measured):
    return decode_measurements(json.loads(measurements_message(7, measured)))


@settings(deadline=None, max_examples=150)
@given(st.lists(st.one_of(imus, odometries, scans(), clouds()), max_size=12))
def test_measurements_come_back_in_their_order_and_as_exact_as_the_page_says(measured):
    found = there_and_back(measured)
    assert [type(each) for each in found] == [type(each) for each in measured]
    for one, other in zip(measured, found, strict=True):
        assert one.stamp_s == other.stamp_s
        if isinstance(one, Imu):
            expected = np.float32([one.angular_velocity_rps, one.linear_acceleration_mps2])
            np.testing.assert_array_equal(
                expected, [other.angular_velocity_rps, other.linear_acceleration_mps2]
            )
        elif isinstance(one, WheelOdometry):
            assert one == other
        elif isinstance(one, Scan2D):
            np.testing.assert_allclose(other.angles_rad, one.angles_rad, atol=1e-9)
            np.testing.assert_allclose(other.times_s, one.times_s, atol=1e-9)
            np.testing.assert_allclose(other.ranges_m, one.ranges_m, atol=2.6e-4)
            assert (other.range_max_m, other.T_base_sensor) == (one.range_max_m, one.T_base_sensor)
        else:
            np.testing.assert_allclose(other.points, one.points, atol=5.1e-4)
            np.testing.assert_allclose(other.times_s, one.times_s, atol=1e-7)
            np.testing.assert_array_equal(other.T_base_sensor, one.T_base_sensor)


def test_a_far_seeing_lidar_is_rounded_coarser_and_not_cut_off():
    far = np.array([0.5, 80.0, np.inf, np.nan], dtype=np.float32)
    scan = Scan2D(1.0, np.arange(4.0), far, np.zeros(4), 0.1, 100.0)
    np.testing.assert_allclose(there_and_back([scan])[0].ranges_m, far, atol=1e-3)


def test_scans_of_one_lidar_tell_its_angles_once():
    angles = np.linspace(-3.0, 3.0, 400) ** 3
    scans = [
        Scan2D(0.1 * k, angles.copy(), np.ones(400, np.float32), np.zeros(400), 0.1, 5.0) for k in range(9)
    ]
    assert len(json.loads(measurements_message(0, scans))["lidars"]) == 1


@pytest.mark.parametrize(
    ("member", "value"),
    [
        ("imu", base64.b64encode(bytes(23)).decode()),
        ("imu", "no base64!"),
        ("ranges", ""),
        ("scan_lidars", [7]),
        ("order", "SS"),
        ("order", "X"),
        ("lidars", []),
    ],
)
def test_a_message_that_does_not_hold_together_is_refused(member, value):
    scan = Scan2D(1.0, np.arange(4.0), np.ones(4, np.float32), np.zeros(4), 0.1, 5.0)
    message = json.loads(measurements_message(0, [scan, Imu(1.0, (0, 0, 0), (0, 0, 9))])) | {member: value}
    with pytest.raises((KeyError, TypeError, ValueError, IndexError)):
        decode_measurements(message)
