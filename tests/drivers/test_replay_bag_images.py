from __future__ import annotations

import json
from itertools import pairwise
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
from explore_bt_drivers import ReplayOptions
from explore_bt_drivers.replay import open_log
from hypothesis import given, settings
from hypothesis import strategies as st
from typer.testing import CliRunner

from explore_bt.cli import app
from explore_bt.errors import LogError
from explore_bt.ros_messages import ImagePairs
from explore_bt.testing.slam_camera import RoomCamera, filmed
from explore_bt.testing.slam_room import Room, ScriptedRobot
from explore_bt.types import Pose2, RgbdFrame, Scan2D
from tests.drivers.ros_bags import FAMILIES, Messages

OPTICAL = (0.5, -0.5, 0.5, -0.5)  # w, x, y, z: x right, y down, z ahead
SIZE = (8, 6)
RGB = np.random.default_rng(0).integers(0, 256, (6, 8, 3), dtype=np.uint8)
MILLIMETRES = np.arange(48, dtype=np.uint16).reshape(6, 8) * 100
MOUNTED = ("base_link", "optical", (0.1, 0.0, 0.5), OPTICAL)


@pytest.fixture(params=list(FAMILIES))
def family(request):
    return FAMILIES[request.param]


def shot(
    make: Messages, stamp_s: float, image: Any = None, depth: Any = None, where: str = "/cam"
) -> list[tuple[str, Any]]:
    """A colour image, and depth 5 ms later."""
    return [
        (f"{where}/color/image_raw", image or make.image(stamp_s, RGB, "rgb8")),
        (f"{where}/depth/image", depth or make.image(stamp_s + 0.005, MILLIMETRES, "16UC1")),
    ]


def filmed_bag(make: Messages, *shots: tuple[str, Any], info: Any = None, tf: str = "/tf_static") -> list:
    return [
        (tf, make.transforms(MOUNTED)),
        ("/scan", make.scan(10.0, [1.0, 2.0])),
        ("/cam/color/camera_info", info or make.camera_info(10.0, SIZE, 5.0)),
        *shots,
    ]


def played(path: Path, **options: Any) -> tuple[list[RgbdFrame], list[str]]:
    log = open_log(ReplayOptions.model_validate({"log": path, **options}))
    return [each for each in log if isinstance(each, RgbdFrame)], log.notes


def refusal(path: Path, **options: Any) -> str:
    with pytest.raises(LogError) as caught:
        played(path, **options)
    assert str(caught.value).startswith(f"{path}: ")
    return str(caught.value).removeprefix(f"{path}: ")


def test_colour_depth_and_intrinsics_become_frames_where_tf_says(family, tmp_path):
    make, write = family
    frames, notes = played(write(tmp_path, filmed_bag(make, *shot(make, 10.1), *shot(make, 10.2))))
    assert [frame.stamp_s for frame in frames] == pytest.approx([10.1, 10.2])
    first = frames[0]
    np.testing.assert_array_equal(first.image, RGB)
    expected = np.where(MILLIMETRES > 0, MILLIMETRES * np.float32(0.001), np.float32(np.nan))
    np.testing.assert_allclose(first.depth_m, expected, rtol=1e-6)
    assert (first.fx, first.fy, first.cx, first.cy) == (5.0, 5.0, 4.0, 3.0)
    ahead, right = first.T_base_sensor[:3, :3] @ [0, 0, 1], first.T_base_sensor[:3, :3] @ [1, 0, 0]
    assert ahead == pytest.approx([1, 0, 0], abs=1e-9)
    assert right == pytest.approx([0, -1, 0], abs=1e-9)
    assert first.T_base_sensor[:3, 3] == pytest.approx([0.1, 0.0, 0.5])
    assert not [note for note in notes if "image" in note]


@pytest.mark.parametrize(
    ("encoding", "pixels", "expected"),
    [
        ("rgb8", RGB, RGB),
        ("bgr8", RGB[:, :, ::-1], RGB),
        ("bgra8", np.dstack((RGB[:, :, ::-1], RGB[:, :, :1])), RGB),
        ("mono8", RGB[:, :, 0], RGB[:, :, 0]),
    ],
)
def test_each_encoding_of_colour_is_read(tmp_path, encoding, pixels, expected):
    make, write = FAMILIES["ros1"]
    image = make.image(10.1, pixels, encoding)
    frames, _ = played(write(tmp_path, filmed_bag(make, *shot(make, 10.1, image))))
    np.testing.assert_array_equal(frames[0].image, expected)


def test_depth_in_metres_and_rows_with_padding_are_read(tmp_path):
    make, write = FAMILIES["mcap"]
    metres = np.full((6, 8), 2.5, dtype=np.float32)
    metres[0, :3] = 0.0, np.inf, np.nan
    padded = np.hstack((metres, np.full((6, 2), 9.0, dtype=np.float32)))
    depth = make.image(10.1, padded, "32FC1", width=8)
    frames, _ = played(write(tmp_path, filmed_bag(make, *shot(make, 10.1, depth=depth))))
    assert np.isnan(frames[0].depth_m[0, :3]).all()
    assert np.nanmin(frames[0].depth_m) == np.nanmax(frames[0].depth_m) == 2.5


def test_a_distorted_image_is_straightened_as_opencv_does(tmp_path):
    make, write = FAMILIES["ros1"]
    D = (0.2, -0.05, 0.01, 0.0, 0.0)
    info = make.camera_info(10.0, SIZE, 5.0, *D)
    frames, _ = played(write(tmp_path, filmed_bag(make, *shot(make, 10.1), info=info)))
    K = np.array([[5.0, 0, 4], [0, 5, 3], [0, 0, 1]])
    expected = cv2.undistort(RGB, K, np.array(D))  # in fixed point: off by a thirty-second of a pixel
    np.testing.assert_allclose(frames[0].image.astype(float), expected, atol=20.0)
    assert (frames[0].image != RGB).any()


def test_a_camera_that_tf_keeps_still_is_mounted_and_one_that_it_moves_is_not(tmp_path):
    make, write = FAMILIES["ros1"]
    still = filmed_bag(make, *shot(make, 10.1), tf="/tf")
    (tmp_path / "still").mkdir()
    frames, _ = played(write(tmp_path / "still", [*still, ("/tf", make.transforms(MOUNTED))]))
    assert frames[0].T_base_sensor[:3, 3] == pytest.approx([0.1, 0.0, 0.5])
    panned = ("base_link", "optical", (0.1, 0.0, 0.5), (1.0, 0.0, 0.0, 0.0))
    frames, notes = played(write(tmp_path, [*still, ("/tf", make.transforms(panned))]))
    assert not frames
    assert 'no images are played: nothing tells where frame "optical" is on the robot' in notes


def test_what_does_not_fit_together_is_not_played_and_said_to_be(tmp_path):
    make, write = FAMILIES["ros1"]
    elsewhere = make.image(10.1, MILLIMETRES, "16UC1", frame="infrared")
    _, notes = played(write(tmp_path, filmed_bag(make, *shot(make, 10.1, depth=elsewhere))))
    assert "no colour image" in notes[0]
    assert "/cam/depth/image (16UC1, 8 × 6, frame infrared)" in notes[0]


def test_of_several_cameras_one_can_be_chosen(tmp_path):
    make, write = FAMILIES["ros1"]
    twice = [*shot(make, 10.1), *shot(make, 10.2, where="/rear")]
    path = write(tmp_path, filmed_bag(make, *twice))
    frames, notes = played(path)
    assert not frames
    assert "the options colour_topic and depth_topic say which" in notes[0]
    chosen = {"colour_topic": "/cam/color/image_raw", "depth_topic": "/cam/depth/image"}
    assert [frame.stamp_s for frame in played(path, **chosen)[0]] == pytest.approx([10.1])
    assert 'no image topic "/front"' in refusal(path, colour_topic="/front")
    assert "there is no CameraInfo on /rear/color/camera_info" in refusal(
        path, colour_topic="/rear/color/image_raw", depth_topic="/rear/depth/image"
    )


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"step": 3}, "144 bytes in rows of 3 for 8 × 6 pixels of rgb8; expected 6 rows of at least 24"),
        ({"data": np.zeros(7, np.uint8)}, "7 bytes in rows of 24 for 8 × 6 pixels"),
        ({"width": 0}, "it has 0 × 6 pixels; expected 1 to 16384 a side"),
        ({"height": 5}, "it has 8 × 5 pixels; /cam/color/camera_info is for 8 × 6"),
    ],
)
def test_a_malformed_image_is_told_with_its_index(family, tmp_path, changed, message):
    make, write = family
    bad = shot(make, 10.2, make.image(10.2, RGB, "rgb8", **changed))
    found = refusal(write(tmp_path, filmed_bag(make, *shot(make, 10.1), *bad)))
    assert found.startswith("message 6 of 7, on /cam/color/image_raw (sensor_msgs/msg/Image): ")
    assert message in found


def test_an_encoding_that_changes_on_the_way_is_told(tmp_path):
    make, write = FAMILIES["ros1"]
    bad = shot(make, 10.2, make.image(10.2, RGB, "yuv422"))
    found = refusal(write(tmp_path, filmed_bag(make, *shot(make, 10.1), *bad)))
    assert 'its encoding is "yuv422"; expected mono8, rgb8' in found


@pytest.mark.parametrize(
    ("focal", "D", "message"),
    [(0.0, (), "expected a calibrated camera"), (5.0, (0.1, 0.1), "with 2 numbers; expected plumb_bob")],
)
def test_intrinsics_that_make_no_sense_are_told(tmp_path, focal, D, message):
    make, write = FAMILIES["ros1"]
    path = write(tmp_path, filmed_bag(make, *shot(make, 10.1), info=make.camera_info(10.0, SIZE, focal, *D)))
    found = refusal(path)
    assert found.startswith("message 3 of 5, on /cam/color/camera_info")
    assert message in found


@settings(deadline=None, max_examples=100)
@given(
    order=st.lists(st.tuples(st.integers(0, 1), st.integers(-3, 3)), max_size=60),
    period_ms=st.integers(50, 100),
)
def test_a_pair_is_never_further_apart_than_20_ms_and_no_image_is_in_two(order, period_ms):
    pairs, counts, made = ImagePairs[tuple[int, int]](), [0, 0], []
    for which, jitter in order:
        stamp_ms = period_ms * counts[which] + jitter
        pair = pairs.take(which, 1e-3 * stamp_ms, (which, stamp_ms))
        counts[which] += 1
        if pair is not None:
            made.append(pair)
    assert all(colour[0] == 0 and depth[0] == 1 for colour, depth in made)
    assert all(abs(colour[1] - depth[1]) <= 20 for colour, depth in made)
    assert all(later[k] > earlier[k] for earlier, later in pairwise(made) for k in (0, 1))


def drive_with_camera(make: Messages) -> list[tuple[str, Any]]:
    """Ten seconds through a textured room."""
    room = Room.furnished()
    robot = ScriptedRobot(room, Pose2(-1.0, 0.0, 0.0), 1)
    camera = RoomCamera(room, np.arange(len(room.segments)), 1)
    measured = list(filmed(robot, camera, robot.drive(0.4, 0.0, 4.0)))
    focal = next(each.fx for each in measured if isinstance(each, RgbdFrame))
    laser = ("base_link", "laser", (0.0, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0))
    messages = [
        ("/tf_static", make.transforms(MOUNTED, laser)),
        ("/cam/color/camera_info", make.camera_info(0.0, (320, 240), focal)),
    ]
    for each in measured:
        if isinstance(each, Scan2D):
            angles = {
                "angle_min": float(each.angles_rad[0]),
                "angle_increment": float(np.diff(each.angles_rad)[0]),
                "time_increment": 0.0,
                "range_max": float(each.range_max_m),
            }
            messages.append(("/scan", make.scan(each.stamp_s, each.ranges_m.tolist(), **angles)))
        elif isinstance(each, RgbdFrame):
            millimetres = np.nan_to_num(1000.0 * each.depth_m).astype(np.uint16)
            grey, depth = (
                make.image(each.stamp_s, pixels, encoding)
                for pixels, encoding in ((each.image, "mono8"), (millimetres, "16UC1"))
            )
            messages += shot(make, each.stamp_s, grey, depth)
    return messages


@pytest.mark.parametrize("name", ["ros1", "mcap"])
@pytest.mark.parametrize("camera", [True, False])
def test_slam_remembers_what_a_bags_camera_saw_if_asked(name, camera, tmp_path):
    make, write = FAMILIES[name]
    path = write(tmp_path, drive_with_camera(make))
    asked = ["slam", str(path), "--out", str(tmp_path / "out"), "--set", f"camera_closures={camera}".lower()]
    shown = CliRunner().invoke(app, asked)
    assert shown.exit_code == 0, shown.output
    assert json.loads((tmp_path / "out" / "result.json").read_text())["notes"] == []
    with np.load(tmp_path / "out" / "slam" / "slam.npz") as saved:
        assert (sum(len(saved[name]) for name in saved.files if "sight" in name) > 0) is camera
