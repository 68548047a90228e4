from __future__ import annotations

import numpy as np
import pytest
from explore_bt_slam.voxel_map import Heights, VoxelMap
from explore_bt_slam.voxel_mapper import VoxelMapper
from numpy.typing import NDArray

from explore_bt.levelling import LevelCloud
from explore_bt.types import FREE, OCCUPIED, UNKNOWN, OccupancyGrid, Pose2

STILL = np.zeros(2)
HEIGHTS = Heights(0.1, 0.6, 1.5)
SENSOR = (0.0, 0.0, 0.5)


def cloud(points: NDArray[np.float64], stamp_s: float = 0.0) -> LevelCloud:
    ends = points.astype(np.float32)
    origins = np.broadcast_to(np.array(SENSOR, np.float32), ends.shape).copy()
    return LevelCloud(stamp_s, np.zeros(len(ends)), ends, ends, origins)


def patch(x: float, y: float, z: float, side_m: float = 0.3) -> NDArray[np.float64]:
    """A level plate, densely hit."""
    across = np.arange(-side_m / 2, side_m / 2 + 1e-9, 0.02)
    a, b = (part.ravel() for part in np.meshgrid(across, across))
    return np.column_stack((x + a, y + b, np.full(a.size, z)))


def room(reach_m: float = 2.0) -> NDArray[np.float64]:
    """A round wall and the floor before it."""
    angles = np.linspace(-np.pi, np.pi, 360, endpoint=False)
    rings = [(reach_m, height) for height in np.arange(0.05, 1.4, 0.05)]
    rings += [(radius, 0.0) for radius in np.arange(0.3, reach_m, 0.04)]
    return np.concatenate(
        [np.column_stack((r * np.cos(angles), r * np.sin(angles), np.full(360, z))) for r, z in rings]
    )


def mapper(*keyframes: Pose2) -> VoxelMapper:
    made = VoxelMapper(0.05, 0.2, HEIGHTS, 5.0, 0)
    made.begin(keyframes[0], Pose2.identity())
    made.follow(np.array([pose.as_array() for pose in keyframes]))
    made.choose_submap(0, np.ones(len(keyframes), np.bool_))
    return made


@pytest.mark.parametrize(
    ("height_m", "wanted"), [(0.0, FREE), (0.05, FREE), (0.15, OCCUPIED), (0.55, OCCUPIED), (0.8, UNKNOWN)]
)
def test_a_plate_blocks_where_the_robot_would_hit_it(height_m: float, wanted: int) -> None:
    ours = mapper(Pose2.identity())
    ours.see_cloud(cloud(patch(1.5, 0.0, height_m)), STILL, Pose2.identity())
    assert ours.grid().value_at(1.5, 0.0) == wanted


def test_a_table_top_blocks_although_the_floor_below_it_is_seen() -> None:
    ours = mapper(Pose2.identity())
    both = np.concatenate((patch(1.5, 0.0, 0.0, 0.6), patch(1.5, 0.0, 0.5, 0.6)))
    ours.see_cloud(cloud(both), STILL, Pose2.identity())
    assert ours.grid().value_at(1.5, 0.0) == OCCUPIED


def test_what_is_above_the_robot_is_passed_under() -> None:
    ours = mapper(Pose2.identity())
    both = np.concatenate((patch(1.5, 0.0, 0.0, 0.6), patch(1.5, 0.0, 0.9, 0.6)))
    ours.see_cloud(cloud(both), STILL, Pose2.identity())
    assert ours.grid().value_at(1.5, 0.0) == FREE


def test_an_obstacle_that_was_taken_away_is_cleared_by_looking_through() -> None:
    ours = mapper(Pose2.identity())
    box = np.concatenate([patch(1.0, 0.0, z, 0.2) for z in np.arange(0.05, 0.7, 0.05)])
    for step in range(20):
        ours.see_cloud(cloud(np.concatenate((room(), box)), float(step)), STILL, Pose2.identity())
    assert ours.grid().value_at(1.0, 0.0) == OCCUPIED
    for step in range(20, 32):
        ours.see_cloud(cloud(room(), float(step)), STILL, Pose2.identity())
    assert ours.grid().value_at(1.0, 0.0) == FREE


def test_an_hour_of_standing_still_takes_no_memory() -> None:
    ours = mapper(Pose2.identity())
    for step in range(20):
        ours.see_cloud(cloud(room(), 0.1 * step), STILL, Pose2.identity())
    before, revision = ours.voxels.memory_bytes, ours.revision
    later = cloud(room())
    for half_minute in range(120):
        late = LevelCloud(30.0 * half_minute + 10.0, later.times_s, later.own, later.ends, later.origins)
        ours.see_cloud(late, STILL, Pose2.identity())
    assert ours.voxels.memory_bytes == before
    assert len(ours.voxels.submaps) == 1
    assert ours.revision == revision
    assert not ours.kept[1:]


def test_driving_to_and_fro_goes_on_in_the_same_submaps() -> None:
    way = [Pose2(0.5 * k, 0.0, 0.0) for k in range(13)]
    ours = mapper(*way)
    sizes = []
    for lap in range(3):
        for step in [*range(13), *range(12, -1, -1)]:
            ours.choose_submap(step, np.ones(13, np.bool_))
            ours.see_cloud(cloud(room(), 100.0 * lap + step), STILL, way[step])
        sizes.append((len(ours.voxels.submaps), ours.voxels.memory_bytes))
    assert sizes[0] == sizes[1] == sizes[2]
    assert 2 <= sizes[0][0] <= 4


def test_a_place_that_is_not_surely_known_gets_a_submap_of_its_own() -> None:
    ours = mapper(Pose2.identity(), Pose2(0.5, 0.0, 0.0))
    ours.choose_submap(1, np.array([True, True]))
    assert len(ours.voxels.submaps) == 1
    ours.choose_submap(1, np.array([False, True]))
    assert len(ours.voxels.submaps) == 2


def test_a_grid_that_followed_the_graph_equals_one_drawn_at_once() -> None:
    before = [Pose2(2.0 * k, 0.0, 0.0) for k in range(4)]
    after = [Pose2(2.0 * k, 0.05 * k * k, 0.03 * k) for k in range(4)]
    ours = mapper(*before)
    for step, pose in enumerate(before):
        ours.choose_submap(step, np.ones(4, np.bool_))
        ours.see_cloud(cloud(room(1.5), float(step)), STILL, pose)
    revision = ours.revision
    ours.follow(np.array([pose.as_array() for pose in after]))
    assert ours.revision > revision
    moved, slow = ours.grid(), _slow_grid(ours.voxels, ours.submap_poses, ours.grid())
    assert np.array_equal(moved.cells, slow)
    assert (slow == OCCUPIED).sum() > 100
    ours.follow(np.array([Pose2(p.x + 0.005, p.y, p.yaw_rad).as_array() for p in after]))
    assert np.array_equal(ours.grid().cells, moved.cells)


def test_only_what_has_moved_is_drawn_again() -> None:
    poses = [Pose2(8.0 * k, 0.0, 0.0) for k in range(3)]
    ours = mapper(*poses)
    for step, pose in enumerate(poses):
        ours.choose_submap(step, np.ones(3, np.bool_))
        ours.see_cloud(cloud(room(1.5), float(step)), STILL, pose)
    before = ours.grid()
    ours.follow(np.array([*(pose.as_array() for pose in poses[:2]), [16.0, 0.2, 0.0]]))
    window = ours.changed_since(before.revision)
    assert window is not None
    assert not window.is_empty
    assert before.origin_xy[0] + window.col0 * 0.05 > 12.0
    away = ours.grid().cells.copy()
    away[window.slices] = before.cells[window.slices]
    assert np.array_equal(away, before.cells)


def test_voxels_are_handed_out_where_they_are_in_the_map() -> None:
    ours = mapper(Pose2(1.0, 2.0, np.pi / 2))
    ours.see_cloud(cloud(patch(1.5, 0.0, 0.31, 0.1)), STILL, Pose2(1.0, 2.0, np.pi / 2))
    keys, log_odds = ours.voxels.voxels(ours.submap_poses)
    assert len(np.unique(keys, axis=0)) == len(keys)
    plate = (keys[(log_odds > 0.0) & (keys[:, 2] == 6)] + 0.5) * 0.05
    assert np.abs(plate[:, 0] - 1.0).max() < 0.11
    assert np.abs(plate[:, 1] - 3.5).max() < 0.11
    assert (log_odds < 0.0).sum() > 100


def _slow_grid(voxels: VoxelMap, poses: NDArray[np.float64], like: OccupancyGrid) -> NDArray[np.int8]:
    """Cell by cell and voxel by voxel, from the saved arrays."""
    arrays = voxels.arrays()
    tables, pool = arrays["voxel_tables"], arrays["voxel_pool"]
    newest = np.argsort(-arrays["voxel_submaps"][:, 4])
    half, brick = tables.shape[1] * 16 // 2, 16
    out = np.full(like.shape, UNKNOWN, np.int8)
    for row in range(like.shape[0]):
        for col in range(like.shape[1]):
            total = np.zeros(pool.shape[3], int)
            for slot in newest:
                x, y = Pose2(*poses[slot].tolist()).inverse().apply(np.array([like.center_of(row, col)]))[0]
                r, c = (int(np.floor(value / 0.05)) + half for value in (y, x))
                if 0 <= r < 2 * half and 0 <= c < 2 * half and tables[slot, r // brick, c // brick] >= 0:
                    column = pool[tables[slot, r // brick, c // brick], r % brick, c % brick]
                    total += np.where(np.abs(total) < 9, column.astype(int), 0)
            band, floor = total[4:14], total[:4]  # from 10 cm below the floor: 0.1 to 0.6 m, and below
            if (band > 0).any():
                out[row, col] = OCCUPIED
            elif (floor > 0).any() or (band < 0).sum() >= 5:
                out[row, col] = FREE
    # before the first sweep the mapper drew the robot's body
    drawn_first = (out == UNKNOWN) & (like.cells == FREE)
    centres = like.centers_of(np.argwhere(drawn_first))
    assert not len(centres) or np.hypot(*centres.T).max() < 0.25
    out[drawn_first] = FREE
    return out
