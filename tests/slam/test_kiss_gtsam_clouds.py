from __future__ import annotations

import dataclasses
import importlib
import math
from collections.abc import Iterable
from pathlib import Path

import numpy as np
import pytest
from explore_bt_slam import KissGtsam, projection, voxel_kernels
from pydantic import ValidationError

from explore_bt import levelling
from explore_bt.errors import PluginError
from explore_bt.interfaces import RobotContext
from explore_bt.testing.balancing_robot import BalancingRobot
from explore_bt.testing.scene3 import Prism, Scene3
from explore_bt.testing.slam_room import Room, ScriptedRobot
from explore_bt.types import FREE, OCCUPIED, UNKNOWN, BodyShape, Imu, Measurement, PointCloud, Pose2


def box(x0: float, y0: float, x1: float, y1: float, low: float = 0.0, high: float = 2.5) -> Prism:
    return Prism(np.array([(x0, y0), (x1, y0), (x1, y1), (x0, y1)]), low, high)


def two_rooms() -> Scene3:
    """10 × 5 m with a wall and a doorway between, a sideboard, a table on legs and a shelf on the wall."""
    walls = [box(-3, -2.6, 7, -2.5), box(-3, 2.5, 7, 2.6), box(-3.1, -2.5, -3, 2.5), box(7, -2.5, 7.1, 2.5)]
    middle = [box(2, -2.5, 2.1, -0.5), box(2, 0.5, 2.1, 2.5)]
    legs = [box(x, y, x + 0.06, y + 0.06, 0.0, 0.7) for x in (4.0, 5.14) for y in (1.0, 1.74)]
    things = [
        box(-1.0, 2.0, 0.6, 2.5, 0.0, 0.8),
        box(4.0, 1.0, 5.2, 1.8, 0.66, 0.7),
        box(5, -2.5, 6.5, -2.2, 1.3),
    ]
    return Scene3([*walls, *middle, *legs, *things])


def ready(robot: BalancingRobot | ScriptedRobot, **options: object) -> KissGtsam:
    slam = KissGtsam(KissGtsam.Options(**options))
    slam.setup(RobotContext(start=robot.pose, footprint_radius_m=0.2))
    return slam


def drive(slam: KissGtsam, *drives: Iterable[Measurement]) -> None:
    for each in drives:
        for measurement in each:
            slam.update(measurement)


def swinging(pose: Pose2) -> BalancingRobot:
    swing = {"pitch_rad": math.radians(9.0), "roll_rad": math.radians(2.0)}
    return BalancingRobot(two_rooms(), pose, columns=450, **swing)


def there(robot: BalancingRobot) -> Iterable[Measurement]:
    yield from robot.drive(0.0, 0.0, 1.0)
    yield from robot.go_to(1.0, 0.0)
    yield from robot.turn(2.0 * math.pi)
    yield from robot.go_to(3.5, 0.0)
    yield from robot.turn(-math.pi)


def test_rooms_are_mapped_from_a_swinging_body() -> None:
    robot = swinging(Pose2(-1.0, 0.0, 0.0))
    slam = ready(robot)
    drive(slam, there(robot))
    assert slam.estimate().T_map_base.distance_to(robot.pose) < 0.06
    grid = slam.grid()
    assert grid.value_at(4.6, 1.4) == OCCUPIED  # under the table: its top is lower than the robot is high
    assert grid.value_at(2.05, 0.0) == FREE  # in the doorway
    assert grid.value_at(0.0, 2.05) == OCCUPIED
    floor = [grid.value_at(x, y) for x in np.arange(-2.5, 1.7, 0.2) for y in np.arange(-2.0, 1.6, 0.2)]
    assert OCCUPIED not in floor
    assert floor.count(FREE) > 0.95 * len(floor)


def test_a_lower_robot_passes_under_the_table() -> None:
    robot = swinging(Pose2(3.0, 0.0, 0.0))
    robot.lidar_height_m = 0.3
    slam = ready(robot, robot_height="50 cm", match_low="0.2 m", match_high="1.5 m")
    drive(slam, robot.drive(0.0, 0.0, 1.0), robot.go_to(4.5, 0.2), robot.turn(math.pi))
    assert slam.grid().value_at(4.6, 1.4) == FREE


def test_turning_on_the_spot_makes_no_keyframe_after_keyframe() -> None:
    robot = swinging(Pose2(-1.0, 0.0, 0.0))
    slam = ready(robot)
    drive(slam, robot.drive(0.0, 0.0, 1.0), robot.turn(6.0 * math.pi))
    assert slam.figures()["keyframes"] <= 3
    assert slam.estimate().T_map_base.distance_to(robot.pose) < 0.03


def test_a_saved_voxel_map_is_gone_on_in(tmp_path: Path) -> None:
    robot = swinging(Pose2(-1.0, 0.0, 0.0))
    slam = ready(robot)
    drive(slam, there(robot))
    slam.save(tmp_path)
    resumed = ready(robot)
    resumed.load(tmp_path)
    assert np.array_equal(resumed.grid().cells, slam.grid().cells)
    one, other = slam.structure().voxels, resumed.structure().voxels
    assert one is not None
    assert other is not None
    assert np.array_equal(one.keys, other.keys)
    assert np.array_equal(one.log_odds, other.log_odds)
    drive(resumed, robot.go_to(0.0, 0.0))
    assert resumed.estimate().T_map_base.distance_to(robot.pose) < 0.06


def test_voxels_and_graph_are_handed_out() -> None:
    robot = swinging(Pose2(-1.0, 0.0, 0.0))
    slam = ready(robot)
    assert slam.structure().voxels is None
    drive(slam, there(robot))
    structure = slam.structure()
    assert structure.voxels is not None
    assert structure.graph is not None
    assert len(structure.graph.poses) == slam.figures()["keyframes"]
    assert len(structure.graph.ends) >= len(structure.graph.poses) - 1
    centres = structure.voxels.occupied_centres
    assert 1.9 < centres[:, 2].max() < 2.0
    near_top = np.abs(centres - [4.6, 1.4, 0.68]).max(axis=1) < 0.1
    assert near_top.any()


@pytest.mark.parametrize(
    "options", [{"floor_height": "3 m"}, {"robot_height": "3 m"}, {"match_low": "0.5 m", "match_high": 0.5}]
)
def test_bands_upside_down_are_refused_by_name(options: dict[str, object]) -> None:
    with pytest.raises(ValidationError, match="has to be the higher one"):
        KissGtsam.Options(**options)


def test_the_first_lidar_that_speaks_is_listened_to() -> None:
    planar = ScriptedRobot(Room.furnished(), Pose2(-1.0, 0.0, 0.0))
    for first, second in ((swinging(planar.pose), planar), (planar, swinging(planar.pose))):
        slam = ready(first)
        drive(slam, first.drive(0.0, 0.0, 0.3))
        pose, grid = slam.estimate().T_map_base, slam.grid()
        assert (grid.cells != UNKNOWN).sum() > 1000
        for measurement in second.drive(0.0, 0.0, 1.0):
            if not isinstance(measurement, Imu):
                slam.update(measurement)
        assert slam.figures()["scans"] == 3
        assert slam.estimate().T_map_base == pose
        assert slam.grid() is grid


def test_no_kernel_compiles_while_the_robot_drives() -> None:
    robot = swinging(Pose2(-1.0, 0.0, 0.0))
    slam = ready(robot)
    before = _signatures()
    assert len(before) >= 10
    drive(slam, robot.drive(0.0, 0.0, 0.5), robot.go_to(0.5, 0.0))
    for measurement in robot.drive(0.0, 0.0, 0.2):
        if isinstance(measurement, PointCloud):
            measurement.points.flags.writeable = False
            measurement = dataclasses.replace(measurement, times_s=measurement.times_s.astype(np.float32))
        slam.update(measurement)
    slam.structure()
    assert _signatures() == before


def test_a_robot_that_is_lower_than_the_floor_band_is_refused_at_set_up() -> None:
    slam = KissGtsam(KissGtsam.Options(floor_height="0.6 m"))
    with pytest.raises(PluginError, match=r"the robot 0\.5 m high, as its driver says"):
        slam.setup(RobotContext(start=Pose2(0.0, 0.0, 0.0), shape=BodyShape(height_m=0.5)))


def test_the_driver_s_word_on_the_body_s_height_counts() -> None:
    """A table top at 0.66 m is an obstacle to a robot of 1 m and none to one of 0.5 m."""
    known = {}
    for height_m in (0.5, 1.0):
        robot = swinging(Pose2(3.5, 0.0, 0.5))
        slam = KissGtsam(KissGtsam.Options())
        slam.setup(RobotContext(start=robot.pose, shape=BodyShape(height_m=height_m)))
        drive(slam, robot.drive(0.0, 0.0, 1.0), robot.turn(2.0 * math.pi))
        known[height_m] = slam.grid().value_at(4.6, 1.1)
    assert known[1.0] == OCCUPIED
    assert known[0.5] != OCCUPIED


def test_floor_about_the_start_is_believed_where_nothing_is_seen_on_it_and_not_behind_walls() -> None:
    """A lidar at 0.5 m sees no floor nearer than 1.9 m; what is behind the wall stays unknown."""
    known = {}
    for clear_m in (0.0, 1.0):
        robot = BalancingRobot(two_rooms(), Pose2(-2.6, 0.0, 0.0))
        slam = ready(robot, clear_start=clear_m, robot_height="1.5 m")
        drive(slam, robot.drive(0.0, 0.0, 1.0))
        known[clear_m] = slam.grid()
    assert known[0.0].value_at(-2.1, 0.2) == UNKNOWN
    assert known[1.0].value_at(-2.1, 0.2) == FREE
    assert known[1.0].value_at(-3.3, 0.0) != FREE
    assert known[1.0].value_at(-3.02, 0.0) == OCCUPIED


def _signatures() -> dict[str, int]:
    """How many versions of each kernel there are by now."""
    parts = ("attitude", "level_cloud", "virtual_scan")
    modules = (
        *(importlib.import_module(f"{levelling.__name__}.{part}") for part in parts),
        voxel_kernels,
        projection,
    )
    kernels = [getattr(module, name) for module in modules for name in vars(module)]
    return {f"{k.__module__}.{k.__name__}": len(k.signatures) for k in kernels if hasattr(k, "signatures")}
