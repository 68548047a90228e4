from __future__ import annotations

import numpy as np
import pytest
from explore_bt_slam.point_to_line import align
from explore_bt_slam.surfels import SurfelMap, normals_of
from numpy.typing import NDArray

from explore_bt.testing.slam_room import Room
from explore_bt.types import Pose2

LOOSE = np.diag([1.0, 1.0, 1.0])


def seen(room: Room, pose: Pose2, seed: int) -> NDArray[np.float64]:
    angles = np.linspace(-np.pi, np.pi, 360, endpoint=False)
    ranges = room.ranges(np.tile(pose.xy, (360, 1)), angles + pose.yaw_rad)
    ranges = ranges + np.random.default_rng(seed).normal(0.0, 0.01, 360)
    near = ranges < 5.0
    angles, ranges = angles[near], ranges[near]
    return np.column_stack((ranges * np.cos(angles), ranges * np.sin(angles)))


def mapped(room: Room, poses: list[Pose2]) -> SurfelMap:
    surfels = SurfelMap((0.0, 0.0), 7.0)
    for seed, pose in enumerate(poses):
        points = seen(room, pose, 100 + seed)
        surfels.add(points, normals_of(points), pose)
    return surfels


@pytest.mark.parametrize("seed", range(4))
def test_a_scan_is_laid_into_a_room_to_the_millimetre(seed: int) -> None:
    rng = np.random.default_rng(seed)
    room = Room.furnished()
    surfels = mapped(room, [Pose2(0.0, 0.0, 0.0), Pose2(0.5, 0.2, 1.0), Pose2(-0.5, 0.0, 2.0)])
    truth = Pose2(0.2, 0.1, 0.5)
    guess = Pose2(*(truth.as_array() + rng.uniform(-1.0, 1.0, 3) * [0.06, 0.06, 0.03]))
    points = seen(room, truth, seed)
    found = align(points, normals_of(points), surfels, guess, guess, LOOSE)
    assert found.pose.distance_to(truth) < 0.004
    assert abs(found.pose.yaw_rad - truth.yaw_rad) < 0.003
    assert found.overlap > 0.8
    assert found.weakest_sigma_m < 0.01


def test_a_plain_corridor_leaves_its_direction_to_the_prediction() -> None:
    walls = np.array([[-30.0, -1.0, 30.0, -1.0], [30.0, 1.0, -30.0, 1.0]])
    corridor = Room(walls, np.zeros((0, 3)))
    surfels = mapped(corridor, [Pose2(0.3 * k, 0.0, 0.0) for k in range(-3, 1)])
    truth, prediction = Pose2(0.35, 0.02, 0.01), Pose2(0.35, 0.0, 0.0)
    points = seen(corridor, truth, 7)
    dragged = Pose2(0.28, 0.0, 0.0)
    found = align(points, normals_of(points), surfels, dragged, prediction, np.diag([1e4, 1e4, 1e4]))
    assert found.weakest_sigma_m > 0.1
    assert abs(found.pose.x - prediction.x) < 0.01
    assert abs(found.pose.y - truth.y) < 0.005
    assert abs(found.pose.yaw_rad - truth.yaw_rad) < 0.005


def test_normals_are_square_to_the_wall_and_look_to_the_robot() -> None:
    y = np.linspace(-1.0, 1.0, 80)
    normals = normals_of(np.column_stack((np.full(80, 1.5), y)))
    assert np.allclose(normals, [-1.0, 0.0], atol=1e-9)


def test_the_two_faces_of_a_thin_wall_stay_apart() -> None:
    x = np.linspace(0.0, 1.0, 60)
    face, back = np.column_stack((x, np.full(60, 0.0))), np.column_stack((x, np.full(60, 0.04)))
    surfels = SurfelMap((0.0, 0.0), 3.0)
    surfels.add(face, np.tile([0.0, -1.0], (60, 1)), Pose2.identity())
    surfels.add(back, np.tile([0.0, 1.0], (60, 1)), Pose2.identity())
    below = surfels.normals[:, 1] < 0.0
    assert np.allclose(surfels.points[below, 1], 0.0)
    assert np.allclose(surfels.points[~below, 1], 0.04)
