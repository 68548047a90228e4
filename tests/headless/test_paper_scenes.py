"""What the paper tells of its robot on the way, as scenes: the strategy ``paper`` behaves as it did there."""

from __future__ import annotations

import math

import numpy as np

from explore_bt import Explorer
from explore_bt.types import FREE, OCCUPIED, UNKNOWN, OccupancyGrid, Pose2, wrap_angle
from tests.headless.drive import advanced, explore, look

STRIDE_M = 1.5


def grid_of(cells: np.ndarray) -> OccupancyGrid:
    return OccupancyGrid(cells, 0.1, (0.0, 0.0))


def corridor() -> OccupancyGrid:
    """20 × 1.8 m within walls."""
    cells = np.full((20, 202), OCCUPIED, dtype=np.int8)
    cells[1:-1, 1:-1] = FREE
    return grid_of(cells)


def test_along_a_corridor_it_goes_forward_from_stride_to_stride() -> None:
    xs, headings = [], []
    for _, pose, decision in explore(Explorer("paper"), corridor(), Pose2(1.0, 1.0, 0.0)):
        xs.append(pose.x)
        if pose.x > 17.0:
            break
        assert decision.goal is not None
        headings.append(decision.goal.yaw_rad)
        assert decision.goal.distance_to(pose) <= STRIDE_M + 0.3
    assert xs[-1] > 17.0
    assert min(np.diff(xs)) > -0.05
    assert max(map(abs, headings)) < math.radians(45.0)


def test_it_leaves_a_dead_end_backwards() -> None:
    """Algorithm 1: without a safe heading, reset the half-planes; still none, turn round and drive back."""
    xs = [pose.x for _, pose, _ in explore(Explorer("paper"), corridor(), Pose2(1.0, 1.0, 0.0))]
    farthest = int(np.argmax(xs))
    assert xs[farthest] > 18.0
    assert min(xs[farthest:]) < 5.0


def with_side_room() -> OccupancyGrid:
    """A corridor with a room of 3 × 9 m on the left, open on 2.4 m."""
    cells = np.full((112, 202), OCCUPIED, dtype=np.int8)
    cells[1:19, 1:201] = FREE
    cells[19:111, 80:110] = FREE
    cells[19, :83] = cells[19, 107:] = OCCUPIED
    return grid_of(cells)


def test_points_1_and_2_noise_turns_it_back_and_once_that_is_gone_it_goes_on() -> None:
    """Noise across the corridor and before the room: no heading ahead is safe, it turns and drives back.

    After that slight movement the map is rid of the noise, and it goes where it had not been.
    """
    truth, explorer, pose = with_side_room(), Explorer("paper"), Pose2(1.0, 1.0, 0.0)
    noisy = truth.cells.copy()
    noisy[:, 125] = noisy[19, :] = OCCUPIED
    known = np.full(truth.shape, UNKNOWN, dtype=np.int8)
    way, turned_back_at = [pose], None
    for revision in range(120):
        if turned_back_at is None and pose.x < max(each.x for each in way) - 1.0:
            turned_back_at = len(way)
        look(grid_of(noisy) if turned_back_at is None else truth, known, pose)
        decision = explorer.decide(OccupancyGrid(known.copy(), 0.1, (0.0, 0.0), revision), pose)
        if decision.done or pose.y > 3.0:
            break
        pose = advanced(decision, pose)
        way.append(pose)
    assert turned_back_at is not None
    assert 10.0 < max(each.x for each in way[:turned_back_at]) < 12.5
    assert abs(way[turned_back_at - 1].yaw_rad) > math.radians(135.0)
    assert pose.y > 3.0


def test_point_3_it_finds_its_way_out_of_an_enclosed_room() -> None:
    """A bathroom of 2 × 2.6 m whose only door, 0.9 m, lies behind the robot's back, off a hall."""
    cells = np.full((70, 102), OCCUPIED, dtype=np.int8)
    cells[1:27, 41:61] = FREE
    cells[27, 47:56] = FREE
    cells[28:69, 1:101] = FREE
    start = Pose2(5.1, 1.0, -0.5 * math.pi)
    way = [pose for _, pose, _ in explore(Explorer("paper"), grid_of(cells), start)]
    first = next(pose for pose in way if pose.y > 3.2)
    assert abs(wrap_angle(first.yaw_rad - 0.5 * math.pi)) < math.radians(45.0)
    assert max(pose.y for pose in way) > 5.0
