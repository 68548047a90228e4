"""The relocaliser alone: a scan of a known or a twin place against keyframes whose poses are the truth."""

from __future__ import annotations

import numpy as np
import pytest
from explore_bt_slam.far_closures import FarClosureFinder
from explore_bt_slam.keyframes import Keyframe
from explore_bt_slam.relocaliser import Relocaliser
from explore_bt_slam.surfels import normals_of
from numpy.typing import NDArray

from explore_bt.testing.slam_room import Room
from explore_bt.types import Pose2, wrap_angle

STEP = Pose2(0.05, 0.0, 0.02)


def angled_room() -> Room:
    """An L of 6 × 5 m with two pillars: it looks like no other pose of itself."""
    corners = [(0.0, 0.0), (6.0, 0.0), (6.0, 2.2), (2.5, 2.2), (2.5, 5.0), (0.0, 5.0)]
    walls = [[*a, *b] for a, b in zip(corners, corners[1:] + corners[:1], strict=True)]
    return Room(np.array(walls), np.array([[4.5, 1.7, 0.2], [0.6, 4.0, 0.3]]))


def scan_at(room: Room, pose: Pose2, driven_m: float, seed: int) -> Keyframe:
    angles = np.linspace(-np.pi, np.pi, 360, endpoint=False)
    ranges = room.ranges(np.tile(pose.xy, (360, 1)), angles + pose.yaw_rad)
    ranges = (ranges + np.random.default_rng(seed).normal(0.0, 0.01, 360))[:, None]
    points = ranges * np.column_stack((np.cos(angles), np.sin(angles)))
    return Keyframe(driven_m, points, normals_of(points), driven_m)


def way_through(room: Room, xs: NDArray[np.float64], y: float) -> tuple[list[Keyframe], NDArray[np.float64]]:
    poses = [Pose2(float(x), y, 0.0) for x in xs]
    keyframes = [scan_at(room, pose, 0.5 * k, k) for k, pose in enumerate(poses)]
    return keyframes, np.array([pose.as_array() for pose in poses])


def sought(
    room: Room, keyframes: list[Keyframe], poses: NDArray[np.float64], first: Pose2, scans: int
) -> tuple[tuple[int, Pose2] | None, Pose2]:
    """What a robot set down at ``first`` finds while it drives; and where it is then.

    Its dead reckoning, which only changes count of, begins at the origin.
    """
    relocaliser, now, believed = Relocaliser(FarClosureFinder()), first, Pose2.identity()
    for number in range(scans):
        found = relocaliser.step(keyframes, poses, scan_at(room, now, 0.0, 100 + number), believed)
        if found is not None:
            return found, now
        now, believed = now.compose(STEP), believed.compose(STEP)
    return None, now


@pytest.mark.parametrize("heading_rad", [0.0, 2.0, -2.5])
def test_a_robot_set_down_in_a_known_room_is_found_at_any_heading(heading_rad: float) -> None:
    room = angled_room()
    keyframes, poses = way_through(room, np.arange(1.0, 3.6, 0.5), 1.0)
    found, now = sought(room, keyframes, poses, Pose2(1.6, 1.3, heading_rad), 6)
    assert found is not None
    assert found[1].distance_to(now) < 0.05
    assert abs(wrap_angle(found[1].yaw_rad - now.yaw_rad)) < 0.02


def test_one_scan_is_not_enough() -> None:
    room = angled_room()
    keyframes, poses = way_through(room, np.arange(1.0, 3.6, 0.5), 1.0)
    found, _ = sought(room, keyframes, poses, Pose2(1.6, 1.3, 1.0), 1)
    assert found is None


def test_a_place_with_a_twin_is_never_entered() -> None:
    hall = [[0.0, 0.0, 8.0, 0.0], [8.0, 0.0, 8.0, 4.0], [8.0, 4.0, 0.0, 4.0], [0.0, 4.0, 0.0, 0.0]]
    walls = np.array([*hall, [4.0, 0.0, 4.0, 4.0]])
    twins = Room(walls, np.array([[1.0, 3.0, 0.2], [5.0, 3.0, 0.2]]))
    left, poses_left = way_through(twins, np.arange(1.0, 3.1, 0.5), 1.5)
    right, poses_right = way_through(twins, np.arange(5.0, 7.1, 0.5), 1.5)
    later = [Keyframe(k.stamp_s, k.points, k.normals, k.driven_m + 20.0) for k in right]
    found, _ = sought(twins, left + later, np.vstack((poses_left, poses_right)), Pose2(2.0, 2.0, 0.7), 8)
    assert found is None


def test_a_room_that_is_not_in_the_map_is_not_found_in_it() -> None:
    keyframes, poses = way_through(angled_room(), np.arange(1.0, 3.6, 0.5), 1.0)
    other = Room(
        np.array([[-2.0, -3.0, 4.0, -3.5], [4.0, -3.5, 3.0, 4.0], [3.0, 4.0, -2.0, -3.0]]), np.zeros((0, 3))
    )
    found, _ = sought(other, keyframes, poses, Pose2(1.0, 0.0, 0.0), 8)
    assert found is None
