from __future__ import annotations

import math
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from explore_bt_drivers import ReplayOptions
from explore_bt_drivers.replay import open_log
from hypothesis import example, given, settings
from hypothesis import strategies as st

from explore_bt.errors import LogError
from explore_bt.types import Imu, Measurement, PointCloud, Pose2, Scan2D, WheelOdometry
from tests.drivers.ros_bags import FAMILIES, Messages

UPSIDE_DOWN = (0.0, 1.0, 0.0, 0.0)  # w, x, y, z: half a turn about x
POSITIONS = re.compile(
    r"^[^ ]+:\d+: |message \d+ of \d+|after message \d+|a message on /|cannot be opened as a ROS bag"
    r"|no LaserScan|metadata|expected a CARMEN log|(at|near|after) byte \d+"
)
LEFT = (math.cos(math.pi / 4), 0.0, 0.0, math.sin(math.pi / 4))


@pytest.fixture(params=list(FAMILIES))
def family(request):
    return FAMILIES[request.param]


def played(path: Path, **options: Any) -> list[Measurement]:
    return list(open_log(ReplayOptions.model_validate({"log": path, **options})))


def refusal(path: Path, **options: Any) -> str:
    with pytest.raises(LogError) as caught:
        played(path, **options)
    assert str(caught.value).startswith(str(path))
    return str(caught.value)


def drive(make: Messages) -> list[tuple[str, Any]]:
    return [
        ("/tf_static", make.transforms(("base_link", "mast", (0.1, 0.0, 0.5), LEFT))),
        ("/odom", make.odometry(9.9, 1.0, 2.0, LEFT)),
        ("/imu", make.imu(9.95, (0.0, 0.0, 0.3), (1.0, 0.0, 9.81))),
        ("/scan", make.scan(10.0, [1.0, math.inf, math.nan, 0.0, 12.0])),
        (
            "/tf_static",
            make.transforms(
                ("mast", "laser", (0.2, 0.0, 0.0), (1, 0, 0, 0)), ("base_link", "imu", (0, 0, 0), LEFT)
            ),
        ),
    ]


def test_a_bag_is_played_as_measurements_in_the_robots_own_axes(family, tmp_path):
    make, write = family
    odometry, imu, scan = played(write(tmp_path, drive(make)))
    assert isinstance(odometry, WheelOdometry)
    assert odometry.stamp_s == pytest.approx(9.9)
    assert odometry.T_odom_base.as_array() == pytest.approx([1.0, 2.0, math.pi / 2])
    assert isinstance(imu, Imu)
    assert imu.angular_velocity_rps == pytest.approx((0.0, 0.0, 0.3))
    assert imu.linear_acceleration_mps2 == pytest.approx((0.0, 1.0, 9.81))
    assert isinstance(scan, Scan2D)
    assert scan.stamp_s == pytest.approx(10.04)  # the last beam's; ROS stamps the first
    assert scan.times_s == pytest.approx([-0.04, -0.03, -0.02, -0.01, 0.0])
    assert scan.angles_rad == pytest.approx([-1.0, -0.5, 0.0, 0.5, 1.0])
    np.testing.assert_array_equal(
        scan.ranges_m, np.array([1.0, np.inf, np.nan, np.nan, np.inf], dtype=np.float32)
    )
    assert scan.T_base_sensor.as_array() == pytest.approx([0.1, 0.2, math.pi / 2])


def test_a_lidar_that_hangs_upside_down_turns_the_other_way(tmp_path):
    make, write = FAMILIES["ros1"]
    hanging = make.transforms(("base_link", "laser", (0, 0, 1), UPSIDE_DOWN))
    (scan,) = played(write(tmp_path, [("/tf_static", hanging), ("/scan", make.scan(1.0, [1, 2, 3, 4, 5]))]))
    assert scan.points()[0] == pytest.approx([math.cos(1.0), math.sin(1.0)], abs=1e-6)


def test_a_frame_that_nothing_ties_to_the_robot_is_base_link_and_said_to_be(tmp_path):
    make, write = FAMILIES["ros1"]
    log = open_log(ReplayOptions(log=write(tmp_path, [("/scan", make.scan(1.0, [1, 2]))])))
    (scan,) = log
    assert scan.T_base_sensor == Pose2.identity()
    assert log.notes == ['nothing tells where frame "laser" is on the robot: taken for base_link']
    assert log.progress == 1.0


def test_a_cloud_keeps_its_points_and_their_times(family, tmp_path):
    make, write = family
    points = np.array([[1, 2, 3], [np.nan, 0, 0], [4, 5, 6]], dtype=np.float32)
    (cloud,) = played(write(tmp_path, [("/points", make.cloud(5.0, points, [0, 40_000_000, 100_000_000]))]))
    assert isinstance(cloud, PointCloud)
    assert cloud.stamp_s == pytest.approx(5.1)
    assert cloud.times_s == pytest.approx([-0.1, -0.06, 0.0])
    np.testing.assert_array_equal(cloud.points, points)
    np.testing.assert_array_equal(cloud.T_base_sensor, np.eye(4))


def test_of_several_lidars_one_has_to_be_chosen(tmp_path):
    make, write = FAMILIES["ros1"]
    path = write(tmp_path, [(f"/scan_{side}", make.scan(1.0, [1, 2])) for side in ("left", "right")])
    assert "several lidars, /scan_left, /scan_right; the option scan_topic says which" in refusal(path)
    log = open_log(ReplayOptions(log=path, scan_topic="/scan_right"))
    assert len(list(log)) == 1
    assert log.passed_over == {"/scan_left": 1}
    assert "lidar topics are /scan_left, /scan_right" in refusal(path, scan_topic="/scan")


def test_a_bag_without_a_lidar_is_told(tmp_path):
    make, write = FAMILIES["ros1"]
    assert "no LaserScan or PointCloud2 in it; topics are /imu" in refusal(
        write(tmp_path, [("/imu", make.imu(1.0, (0, 0, 0), (0, 0, 9)))])
    )


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"angle_increment": math.nan}, "angle_increment is nan; expected a finite number"),
        ({"time_increment": -0.1}, "time_increment is -0.1 s for 2 beams; expected a sweep of 0 to 5 s"),
        ({"range_max": 0.0}, "range_max is 0 m; expected more than 0"),
    ],
)
def test_a_message_that_makes_no_sense_is_told_with_its_index(tmp_path, changed, message):
    make, write = FAMILIES["ros1"]
    path = write(tmp_path, [("/scan", make.scan(1.0, [1, 2])), ("/scan", make.scan(2.0, [1, 2], **changed))])
    assert refusal(path) == f"{path}: message 2 of 2, on /scan (sensor_msgs/msg/LaserScan): {message}"


def test_a_cloud_that_is_shorter_than_it_says_is_told(tmp_path):
    make, write = FAMILIES["ros1"]
    cloud = make.cloud(1.0, np.ones((3, 3)), [0, 0, 0])
    cloud.data = cloud.data[:40]
    assert "40 bytes of data for 3 points of 16 bytes" in refusal(write(tmp_path, [("/points", cloud)]))


def test_a_bag_that_is_cut_off_is_told_what_to_do(tmp_path):
    make, write = FAMILIES["ros1"]
    path = write(tmp_path, drive(make))
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])
    assert "a bag that is cut off or was never closed needs rosbag reindex" in refusal(path)


def test_a_folder_that_is_no_bag_is_told(tmp_path):
    assert "a folder without metadata.yaml; expected a ROS 2 bag" in refusal(tmp_path)


def filmed(make: Messages) -> list[tuple[str, Any]]:
    """A camera's messages, so that mutations meet them too."""
    optical = ("base_link", "optical", (0.0, 0.0, 0.5), (0.5, -0.5, 0.5, -0.5))
    return [
        ("/tf", make.transforms(optical)),
        ("/camera_info", make.camera_info(10.0, (4, 3), 5.0)),
        ("/image_raw", make.image(10.0, np.ones((3, 4, 3), np.uint8), "rgb8")),
        ("/depth", make.image(10.0, np.ones((3, 4), np.uint16), "16UC1")),
    ]


@pytest.fixture(scope="module")
def bags(tmp_path_factory) -> dict[str, Path]:
    return {
        name: write(tmp_path_factory.mktemp(name), drive(make) + filmed(make))
        for name, (make, write) in FAMILIES.items()
    }


@settings(deadline=None, max_examples=90)
@given(
    name=st.sampled_from(list(FAMILIES)),
    place=st.floats(0.0, 0.999),
    new=st.binary(min_size=1, max_size=8),
    cut=st.booleans(),
)
@example(name="ros1", place=0.0, new=b"BZh", cut=False)  # first bytes that make it another kind of log
@example(name="ros1", place=0.0, new=b"BZh", cut=True)
@example(name="ros1", place=0.0, new=b"\x1f\x8b", cut=False)
@example(name="ros1", place=0.0, new=b"\x89MCAP0\r\n", cut=False)
def test_a_mutated_bag_is_read_or_is_a_log_error(bags, tmp_path_factory, name, place, new, cut):
    folder, bag = tmp_path_factory.mktemp("fuzz"), bags[name]
    if bag.is_dir():
        path = folder / bag.name
        path.mkdir()
        (path / "metadata.yaml").write_bytes((bag / "metadata.yaml").read_bytes())
        (source,) = (file for file in bag.iterdir() if file.suffix != ".yaml")
        target = path / source.name
    else:
        source, target = bag, folder / bag.name
        path = target
    content = source.read_bytes()
    at = int(place * len(content))
    target.write_bytes(content[:at] + new + (b"" if cut else content[at + len(new) :]))
    told = ""
    try:
        played(path)
    except LogError as fault:
        told = str(fault)
    assert told.startswith(str(path) if told else "")
    assert not told or POSITIONS.search(told), told
