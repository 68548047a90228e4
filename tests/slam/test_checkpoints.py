from __future__ import annotations

import math
from collections.abc import Iterable
from pathlib import Path

import numpy as np
import pytest
from explore_bt_slam import KissGtsam

from explore_bt.interfaces import Resumption, RobotContext
from explore_bt.testing.slam_room import Room, ScriptedRobot
from explore_bt.types import Health, Measurement, Pose2

START = Pose2(-0.6, -0.5, 0.0)


def ready(start: Pose2, resumed: Resumption | None = None) -> KissGtsam:
    slam = KissGtsam(KissGtsam.Options())
    slam.setup(RobotContext(start=start, resumed=resumed))
    return slam


def take(slam: KissGtsam, measurements: Iterable[Measurement]) -> None:
    for measurement in measurements:
        slam.update(measurement)


def there_and_back(robot: ScriptedRobot, times: int) -> Iterable[Measurement]:
    for _ in range(times):
        yield from robot.drive(0.4, 0.5, 4.0)
        yield from robot.drive(0.0, 1.0, math.pi)


def resumed_from(folder: Path, slam: KissGtsam, stamp_s: float) -> KissGtsam:
    pose = slam.estimate().T_map_base
    again = ready(pose, Resumption(stamp_s, pose))
    again.load(folder)
    return again


def test_a_checkpoint_holds_what_a_saved_map_holds(tmp_path: Path) -> None:
    robot = ScriptedRobot(Room.furnished(), START)
    slam = ready(robot.pose)
    take(slam, there_and_back(robot, 2))
    slam.save(tmp_path / "saved")
    slam.begin_save(tmp_path / "checkpoint", None)()
    one, other = (resumed_from(tmp_path / name, slam, robot.time_s) for name in ("saved", "checkpoint"))
    assert np.array_equal(one.grid().cells, other.grid().cells)
    assert np.array_equal(one.trajectory().poses, other.trajectory().poses)
    assert one.figures()["keyframes"] == other.figures()["keyframes"] > 5


def test_a_checkpoint_is_of_the_moment_it_was_begun_at(tmp_path: Path) -> None:
    robot = ScriptedRobot(Room.furnished(), START)
    slam = ready(robot.pose)
    take(slam, robot.drive(0.4, 0.5, 2.0))
    cells, way = slam.grid().cells.copy(), slam.trajectory()
    write = slam.begin_save(tmp_path, None)
    stamp_s, pose = robot.time_s, slam.estimate().T_map_base
    take(slam, there_and_back(robot, 1))
    write()
    again = ready(pose, Resumption(stamp_s, pose))
    again.load(tmp_path)
    assert np.array_equal(again.grid().cells, cells)
    assert np.array_equal(again.trajectory().stamps_s, way.stamps_s)


def test_what_has_not_changed_is_linked_and_not_written_again(tmp_path: Path) -> None:
    robot = ScriptedRobot(Room.furnished(), START)
    slam = ready(robot.pose)
    take(slam, there_and_back(robot, 4))
    slam.begin_save(tmp_path / "first", None)()
    take(slam, there_and_back(robot, 1))
    slam.begin_save(tmp_path / "second", tmp_path / "first")()
    full = sorted(each.name for each in (tmp_path / "first").glob("sweeps-0*.npz"))
    assert full
    for name in full:
        assert (tmp_path / "second" / name).samefile(tmp_path / "first" / name)
    again = resumed_from(tmp_path / "second", slam, robot.time_s)
    assert np.array_equal(again.grid().cells, slam.grid().cells)


def test_a_slam_that_goes_on_drives_as_the_one_that_was_never_cut(tmp_path: Path) -> None:
    robot = ScriptedRobot(Room.furnished(), START)
    slam = ready(robot.pose)
    take(slam, robot.drive(0.4, 0.5, 3.0))
    slam.begin_save(tmp_path, None)()
    again = resumed_from(tmp_path, slam, robot.time_s)
    rest = list(there_and_back(robot, 2))
    take(slam, rest)
    take(again, rest)
    apart = slam.estimate().T_map_base.between(again.estimate().T_map_base)
    assert math.hypot(apart.x, apart.y) < 0.01
    assert abs(apart.yaw_rad) < 0.01
    assert again.estimate().T_map_base.distance_to(robot.pose) < 0.02


@pytest.mark.parametrize(
    ("rolled_m", "turned_deg"), [(0.0, 0.0), (0.4, 0.0), (0.3, 60.0), (0.2, -120.0), (0.0, 180.0)]
)
def test_a_robot_that_rolled_on_while_nobody_measured_is_found(
    tmp_path: Path, rolled_m: float, turned_deg: float
) -> None:
    robot = ScriptedRobot(Room.furnished(), START)
    slam = ready(robot.pose)
    take(slam, there_and_back(robot, 2))
    slam.begin_save(tmp_path, None)()
    again = resumed_from(tmp_path, slam, robot.time_s)
    again.pick_up()
    before = again.grid().occupied.sum()
    moved = robot.pose.compose(Pose2(rolled_m, 0.0, math.radians(turned_deg)))
    woken = ScriptedRobot(Room.furnished(), moved, seed=1, time_s=robot.time_s)
    take(again, woken.drive(0.0, 0.0, 2.0))
    assert again.estimate().health is Health.OK
    assert again.estimate().T_map_base.distance_to(woken.pose) < 0.05
    assert again.grid().occupied.sum() < 1.1 * before  # nothing was drawn at a wrong place
