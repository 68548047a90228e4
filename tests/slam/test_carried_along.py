"""A robot in a plain corridor whose speed the filter has wrong: the camera sees the walls go by."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable, Iterator

import numpy as np
import pytest
from explore_bt_slam import KissGtsam
from explore_bt_slam.camera import Camera, Look
from explore_bt_slam.sight import SightMaker

from explore_bt.interfaces import RobotContext
from explore_bt.testing.slam_camera import PLAIN, RoomCamera, filmed
from explore_bt.testing.slam_room import Room, ScriptedRobot
from explore_bt.types import Imu, Measurement, Pose2

CORRIDOR = Room(
    np.array([[-1.0, 1.0, 40.0, 1.0], [-1.0, -1.0, 40.0, -1.0], [-1.0, -1.0, -1.0, 1.0]]), np.zeros((0, 3))
)


def pushed(
    measured: Iterable[Measurement], begin_s: float, end_s: float, push_mps2: float
) -> Iterator[Measurement]:
    """An accelerometer that feels a push between two times."""
    for each in measured:
        if isinstance(each, Imu) and begin_s <= each.stamp_s < end_s:
            x, y, z = each.linear_acceleration_mps2
            each = dataclasses.replace(each, linear_acceleration_mps2=(x + push_mps2, y, z))
        yield each


def driven(
    texture: int, push_mps2: float, speed_mps: float = 0.5, seconds: float = 36.0
) -> tuple[float, KissGtsam]:
    """How far from the truth SLAM ends, and SLAM."""
    robot = ScriptedRobot(CORRIDOR, Pose2(0.0, 0.0, 0.0))
    camera = RoomCamera(CORRIDOR, np.full(3, texture) if texture == PLAIN else np.arange(3) + texture)
    slam = KissGtsam(KissGtsam.Options())
    slam.setup(RobotContext(start=robot.pose))
    course = robot.drive(speed_mps, 0.0, seconds)
    for measurement in filmed(robot, camera, pushed(course, 15.0, 25.0, push_mps2)):
        slam.update(measurement)
    return slam.estimate().T_map_base.distance_to(robot.pose), slam


@pytest.mark.parametrize("push_mps2", [-0.08, 0.05])
def test_a_robot_that_takes_itself_for_slower_than_it_is_makes_keyframes_all_the_same(
    push_mps2: float,
) -> None:
    """Without that the first one ended 12 m off: it believed to stand, and no keyframe saw a step."""
    off_m, _ = driven(0, push_mps2)
    assert off_m < 0.5


@pytest.mark.parametrize("texture", [0, PLAIN])
def test_a_robot_at_rest_in_a_plain_corridor_makes_no_keyframes(texture: int) -> None:
    _, slam = driven(texture, 0.0, speed_mps=0.0, seconds=20.0)
    assert slam.figures()["keyframes"] <= 2


def test_a_look_is_the_step_that_a_keyframe_there_would_have_seen() -> None:
    room_camera, camera = RoomCamera(CORRIDOR, np.arange(3)), Camera()
    begin, now = Pose2(5.0, 0.0, 0.0), Pose2(5.4, 0.02, 0.03)
    camera.first(room_camera.frame(0.0, begin), Pose2.identity())
    assert camera.look(Pose2.identity()) == Look()
    camera.take(room_camera.frame(1.0, now), Pose2.identity())
    believed = Pose2.identity()
    looked = camera.look(believed)
    assert looked.is_rich
    assert looked.match is not None
    assert looked.match.relative.distance_to(begin.between(now)) < 0.05
    camera.sight(1.0, believed)
    step = camera.step()
    assert step is not None
    assert step.relative == looked.match.relative
    camera.take(room_camera.frame(1.2, now), Pose2.identity())
    camera.forget()
    assert camera.look(believed) == Look()


def test_a_view_without_texture_is_not_rich() -> None:
    camera = Camera()
    camera.take(
        RoomCamera(CORRIDOR, np.full(3, PLAIN), grey_noise=0.0).frame(0.0, Pose2(5.0, 0.0, 0.0)),
        Pose2.identity(),
    )
    assert camera.look(Pose2.identity()) == Look()


def test_features_are_sought_where_there_is_depth() -> None:
    """A far wall full of corners must not use up what the near ones could give."""
    frame = RoomCamera(CORRIDOR, np.arange(3)).frame(0.0, Pose2(5.0, 0.0, 0.0))
    far = np.random.default_rng(0).integers(0, 256, frame.image.shape, dtype=np.uint8)
    is_near = frame.depth_m < 3.0
    busy = dataclasses.replace(
        frame,
        image=np.where(is_near, frame.image, far),
        depth_m=np.where(is_near, frame.depth_m, np.float32(np.nan)),
    )
    alone = dataclasses.replace(busy, image=np.where(is_near, frame.image, np.uint8(128)))
    found, expected = (SightMaker().sight(each, Pose2.identity()).points.shape[0] for each in (busy, alone))
    assert expected > 30
    assert found > 0.8 * expected
