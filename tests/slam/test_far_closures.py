from __future__ import annotations

import numpy as np
from explore_bt_slam.back_end import BackEnd
from explore_bt_slam.far_closures import FarClosureFinder
from explore_bt_slam.keyframes import Keyframe
from explore_bt_slam.surfels import normals_of

from explore_bt.testing.slam_room import Room
from explore_bt.types import Pose2
from tests.slam.driven_ways import along, drifting, equal_rooms, rectangle, ring_of_cupboards, sweep_at


def false_closures(end: BackEnd, way: list[Pose2]) -> list[tuple[int, int]]:
    return [
        (edge.a, edge.b)
        for edge in end.edges
        if edge.is_closure and way[edge.a].between(way[edge.b]).distance_to(edge.relative) > 0.3
    ]


def test_a_loop_with_tens_of_metres_of_drift_is_closed() -> None:
    lap = [(-24.0, -14.0), (24.0, -14.0), (24.0, 14.0), (-24.0, 14.0), (-24.0, -14.0), (0.0, -14.0)]
    way = list(along(lap))
    slips = {60: (1.2, 0.3, 0.3), 130: (0.8, -0.8, 0.22), 230: (1.5, 0.4, 0.15)}
    end, worst = drifting(ring_of_cupboards(), way, slips, 5)
    assert worst > 20.0, "the test is worth nothing unless the way leads astray"
    assert not false_closures(end, way)
    seen = min(range(100), key=lambda k: way[k].distance_to(way[-1]))
    believed = end.pose(seen).between(end.pose(len(way) - 1))
    assert way[seen].between(way[-1]).distance_to(believed) < 0.1


def test_equal_rooms_along_a_corridor_never_close_a_false_loop() -> None:
    count = 6
    corners = [(-1.0, 0.8)]
    for k in [*range(count), *reversed(range(count))]:
        corners += [(4.0 * k + 1.8, 0.8), (4.0 * k + 1.8, 3.0), (4.0 * k + 1.8, 0.8)]
    way = list(along(corners))
    every: list[dict[int, tuple[float, float, float]]] = [
        {},
        dict.fromkeys(range(20, len(way), 28), (0.7, 0.1, 0.03)),
    ]
    for slips in every:
        end, _ = drifting(equal_rooms(count), way, slips, 1)
        assert not false_closures(end, way)


def test_a_hall_too_wide_to_see_its_walls_is_crossed_and_left() -> None:
    """For 40 m no beam returns anything; drift grows, and places without a single point are in question."""
    hall = Room(np.array(rectangle(-30.0, -12.0, 30.0, 12.0)), np.zeros((0, 3)))
    way = list(along([(-25.0, 0.0), (25.0, 0.0), (-25.0, 0.0)]))
    slips = dict.fromkeys(range(10, len(way), 10), (0.15, 0.0, 0.02))
    end, _ = drifting(hall, way, slips, 2)
    assert not false_closures(end, way)


def test_of_each_place_one_grid_is_kept_and_redrawn_while_the_robot_drives_on() -> None:
    way = list(along([(-24.0, -14.0), (-10.0, -14.0)]))
    sweeps = [sweep_at(ring_of_cupboards(), pose, k) for k, pose in enumerate(way)]
    keyframes = [
        Keyframe(float(k), sweep.points, normals_of(sweep.points), 0.5 * k) for k, sweep in enumerate(sweeps)
    ]
    poses = np.array([pose.as_array() for pose in way])
    finder, piece = FarClosureFinder(), keyframes[4].points
    finder.sightings(keyframes[:6], poses[:6], piece, 0.0, {4: 0.1})
    early = finder.sightings(keyframes, poses, keyframes[12].points, 0.0, {4: 0.1})
    fresh = FarClosureFinder().sightings(keyframes, poses, keyframes[12].points, 0.0, {4: 0.1})
    assert early == fresh
