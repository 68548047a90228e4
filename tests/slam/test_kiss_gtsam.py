from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterable
from pathlib import Path

import numpy as np
import pytest
from explore_bt_slam import GroundTruthSlam, KissGtsam
from numpy.typing import NDArray

from explore_bt.errors import PluginError, UserError
from explore_bt.interfaces import RobotContext
from explore_bt.testing.slam_room import Room, ScriptedRobot
from explore_bt.types import Health, Imu, Measurement, Pose2, Scan2D


def boxes(*sides: tuple[float, float, float, float]) -> Room:
    """A room whose walls are the sides of these rectangles."""
    segments = []
    for x0, y0, x1, y1 in sides:
        corners = [(x0, y0), (x1, y0), (x1, y1), (x0, y1)]
        segments += [[*a, *b] for a, b in zip(corners, corners[1:] + corners[:1], strict=True)]
    return Room(np.array(segments), np.zeros((0, 3)))


def ring() -> Room:
    """A corridor 1.6 m wide about an 8 × 6 m core, with cupboards that tell its sides apart."""
    core, outer = (-4.0, -3.0, 4.0, 3.0), (-5.6, -4.6, 5.6, 4.6)
    cupboards = [
        (-2.0, -4.6, -1.2, -4.3),
        (2.0, -3.2, 2.5, -3.0),
        (5.4, -1.0, 5.6, 0.5),
        (4.0, 1.0, 4.2, 2.0),
    ]
    cupboards += [
        (0.5, 4.3, 1.8, 4.6),
        (-3.0, 3.0, -2.0, 3.2),
        (-5.6, 0.5, -5.3, 1.2),
        (-4.2, -2.0, -4.0, -1.5),
    ]
    return boxes(core, outer, *cupboards)


def round_the_ring(robot: ScriptedRobot, laps: int) -> Iterable[Measurement]:
    for _ in range(laps):
        for length_m in (9.6, 7.6, 9.6, 7.6):
            yield from robot.drive(0.5, 0.0, length_m / 0.5)
            yield from robot.drive(0.0, 1.0, math.pi / 2)


def ready(robot: ScriptedRobot, **options: object) -> KissGtsam:
    slam = KissGtsam(KissGtsam.Options(**options))
    slam.setup(RobotContext(start=robot.pose))
    return slam


def errors(slam: KissGtsam, robot: ScriptedRobot) -> NDArray[np.float64]:
    trajectory = slam.trajectory()
    truth = np.array([robot.pose_at(stamp_s).as_array() for stamp_s in trajectory.stamps_s])
    return np.hypot(*(trajectory.poses - truth)[:, :2].T)


def drive(slam: KissGtsam, measurements: Iterable[Measurement]) -> None:
    for measurement in measurements:
        slam.update(measurement)


def test_a_lap_and_a_half_is_closed_to_centimetres() -> None:
    robot = ScriptedRobot(ring(), Pose2(-4.8, -3.8, 0.0))
    slam = ready(robot)
    drive(slam, round_the_ring(robot, 1))
    drive(slam, robot.drive(0.5, 0.0, 12.0))
    off = errors(slam, robot)
    assert slam.figures()["loop_closures"] >= 5
    assert np.sqrt(np.mean(off**2)) < 0.05
    assert off[-1] < 0.03


def test_the_track_is_found_again_after_a_gap_with_a_lying_gyroscope() -> None:
    robot = ScriptedRobot(ring(), Pose2(-4.8, -3.8, 0.0))
    slam = ready(robot)
    for measurement in robot.drive(0.5, 0.0, 18.0):
        slam.update(_misled(measurement, (14.0, 15.6)))
    assert slam.estimate().health is Health.OK
    off = slam.estimate().T_map_base.between(robot.pose)
    assert math.hypot(off.x, off.y) < 0.10
    assert abs(off.yaw_rad) < 0.01


def _misled(measurement: Measurement, blind: tuple[float, float]) -> Measurement:
    if not blind[0] <= measurement.stamp_s <= blind[1]:
        return measurement
    if isinstance(measurement, Scan2D):
        return dataclasses.replace(measurement, ranges_m=np.full_like(measurement.ranges_m, np.nan))
    if isinstance(measurement, Imu):
        x, y, z = measurement.angular_velocity_rps
        return dataclasses.replace(measurement, angular_velocity_rps=(x, y, z + 0.09))
    return measurement


def long_ring() -> Room:
    """A ring whose lower side is a plain corridor of 23 m: nothing there tells how far one has come."""
    core, outer = (-10.0, -3.0, 10.0, 3.0), (-11.6, -4.6, 11.6, 4.6)
    cupboards = [
        (11.3, -1.0, 11.6, 0.5),
        (10.0, 1.0, 10.3, 2.0),
        (-11.6, 0.5, -11.2, 1.2),
        (-10.3, -2.0, -10.0, -1.5),
    ]
    cupboards += [(x, 4.3, x + 0.7, 4.6) for x in (-9.0, -5.5, -1.0, 2.0, 5.0, 8.5)]
    return boxes(core, outer, *cupboards)


def test_drift_in_a_plain_corridor_is_taken_out_when_the_loop_closes() -> None:
    robot = ScriptedRobot(long_ring(), Pose2(-10.8, 3.8, -math.pi / 2))
    slam = ready(robot)
    worst = 0.0
    for length_m, drag_mps2 in ((7.6, 0.0), (21.6, 0.01), (7.6, 0.0), (21.6, 0.0), (7.6, 0.0)):
        for measurement in robot.drive(0.5, 0.0, length_m / 0.5):
            slam.update(_pushed(measurement, drag_mps2))
        worst = max(worst, slam.estimate().T_map_base.distance_to(robot.pose))
        drive(slam, robot.drive(0.0, 1.0, math.pi / 2))
    assert worst > 0.3, "the test is worth nothing unless the corridor leads astray"
    assert slam.figures()["loop_closures"] >= 5
    assert slam.estimate().T_map_base.distance_to(robot.pose) < 0.10


def _pushed(measurement: Measurement, along_mps2: float) -> Measurement:
    """An accelerometer that feels what is not there."""
    if isinstance(measurement, Imu):
        x, y, z = measurement.linear_acceleration_mps2
        return dataclasses.replace(measurement, linear_acceleration_mps2=(x + along_mps2, y, z))
    return measurement


def hotel() -> Room:
    """Four identical rooms, 3 × 3 m, along a corridor 1.6 m wide: doors 0.9 m, the same desk in each."""
    segments = [[-1.0, 0.0, 13.0, 0.0], [-1.0, 0.0, -1.0, 1.6], [13.0, 0.0, 13.0, 1.6]]
    for k in range(4):
        x = 3.0 * k
        segments += [[x, 1.6, x + 1.0, 1.6], [x + 1.9, 1.6, x + 3.0, 1.6], [x, 4.6, x + 3.0, 4.6]]
        segments += [[x, 1.6, x, 4.6], [x + 3.0, 1.6, x + 3.0, 4.6]]
        segments += [[x + 2.2, 3.6, x + 3.0, 3.6], [x + 2.2, 3.6, x + 2.2, 4.6]]
    segments += [[-1.0, 1.6, 0.0, 1.6], [12.0, 1.6, 13.0, 1.6]]
    return Room(np.array(segments), np.zeros((0, 3)))


def test_rooms_that_look_the_same_are_not_taken_for_one_another() -> None:
    robot = ScriptedRobot(hotel(), Pose2(1.45, 0.8, math.pi / 2))
    slam = ready(robot)
    for _ in range(4):
        drive(slam, robot.drive(0.5, 0.0, 4.4))
        drive(slam, robot.drive(0.0, 1.2, math.pi / 1.2))
        drive(slam, robot.drive(0.5, 0.0, 4.4))
        drive(slam, robot.drive(0.0, 1.2, math.pi / 2.4))
        drive(slam, robot.drive(0.5, 0.0, 6.0 if robot.pose.x < 9.0 else 1.0))
        drive(slam, robot.drive(0.0, 1.2, math.pi / 2.4))
    assert errors(slam, robot).max() < 0.10


def test_the_environment_has_no_say(monkeypatch: pytest.MonkeyPatch) -> None:
    def poses() -> NDArray[np.float64]:
        robot = ScriptedRobot(Room.furnished(), Pose2(-0.6, -0.5, 0.0))
        slam = ready(robot)
        drive(slam, robot.drive(0.4, 0.3, 2.0))
        return slam.trajectory().poses

    before = poses()
    monkeypatch.setenv("kiss_icp_mapping", '{"voxel_size": 3.0}')
    monkeypatch.setenv("kiss_icp_registration", '{"max_num_iterations": 1}')
    assert np.array_equal(before, poses())


def test_wheels_are_not_heard_unless_a_mission_says_so() -> None:
    def poses(with_wheels: bool) -> NDArray[np.float64]:
        robot = ScriptedRobot(Room.furnished(), Pose2(-0.6, -0.5, 0.0))
        slam = ready(robot)
        measured = robot.drive(0.4, 0.3, 2.0)
        drive(slam, (each for each in measured if with_wheels or isinstance(each, Imu | Scan2D)))
        return slam.trajectory().poses

    assert np.array_equal(poses(with_wheels=True), poses(with_wheels=False))


def test_it_works_without_an_imu() -> None:
    robot = ScriptedRobot(Room.furnished(), Pose2(-0.6, -0.5, 0.0))
    slam = ready(robot)
    for turn_rate in (0.0, 0.6, -0.6, 0.0, 1.0):
        drive(slam, (each for each in robot.drive(0.3, turn_rate, 1.5) if isinstance(each, Scan2D)))
    assert errors(slam, robot).max() < 0.05


def test_a_corridor_is_reported_and_carried_through() -> None:
    robot = ScriptedRobot(boxes((-1.0, -1.0, 25.0, 1.0)), Pose2(0.0, 0.0, 0.0))
    slam = ready(robot)
    drive(slam, robot.drive(0.0, 0.0, 1.0))
    drive(slam, robot.drive(0.5, 0.0, 20.0))
    assert slam.estimate().health is Health.DEGRADED
    assert "corridor" in slam.estimate().reason
    drive(slam, robot.drive(0.0, 0.0, 3.0))
    drive(slam, robot.drive(0.5, 0.0, 24.0))
    drive(slam, robot.drive(0.0, 0.0, 1.0))
    assert slam.estimate().health is Health.OK
    assert slam.estimate().T_map_base.distance_to(robot.pose) < 1.5
    sigma = math.sqrt(slam.estimate().covariance[0, 0])
    assert slam.estimate().T_map_base.distance_to(robot.pose) < 4.0 * sigma


def test_the_middle_of_an_empty_hall_is_survived() -> None:
    robot = ScriptedRobot(boxes((-8.0, -8.0, 8.0, 8.0)), Pose2(0.0, 0.0, 0.0))
    slam = ready(robot)
    drive(slam, robot.drive(0.0, 0.0, 1.0))
    drive(slam, robot.drive(0.5, 0.0, 5.0))
    assert slam.estimate().health is Health.DEGRADED
    drive(slam, robot.drive(0.5, 0.1, 6.0))
    assert slam.estimate().health is not Health.LOST
    assert slam.estimate().T_map_base.distance_to(robot.pose) < 0.5


def test_scans_that_contradict_the_map_are_reported_lost_and_do_not_enter_it() -> None:
    robot = ScriptedRobot(Room.furnished(), Pose2(-0.6, -0.5, 0.0))
    slam = ready(robot)
    drive(slam, robot.drive(0.3, 0.3, 2.0))
    kidnapped = ScriptedRobot(boxes((-0.4, -0.4, 4.0, 0.4)), Pose2(0.0, 0.0, 0.0), time_s=robot.time_s)
    drive(slam, kidnapped.drive(0.0, 0.0, 0.2))
    before = slam.grid().cells.copy()
    drive(slam, kidnapped.drive(0.0, 0.0, 2.0))
    assert slam.estimate().health is Health.LOST
    assert np.array_equal(slam.grid().cells, before)


def test_a_damaged_or_foreign_file_is_named(tmp_path: Path) -> None:
    robot = ScriptedRobot(Room.furnished(), Pose2(-0.6, -0.5, 0.0))
    slam = ready(robot)
    drive(slam, robot.drive(0.3, 0.3, 1.0))
    slam.save(tmp_path)
    with pytest.raises(UserError, match=r"expected 0\.1"):
        ready(robot, resolution=0.1).load(tmp_path)
    file = tmp_path / "slam.npz"
    file.write_bytes(file.read_bytes()[:1000])
    with pytest.raises(UserError, match=r"slam.npz is damaged"):
        slam.load(tmp_path)


def test_a_second_session_closes_loops_with_the_first(tmp_path: Path) -> None:
    robot = ScriptedRobot(ring(), Pose2(-4.8, -3.8, 0.0))
    first = ready(robot)
    drive(first, robot.drive(0.5, 0.0, 19.2))
    drive(first, robot.drive(0.0, 1.0, math.pi))
    first.save(tmp_path)
    second = ready(robot)
    second.load(tmp_path)
    before = second.figures()["loop_closures"]
    drive(second, robot.drive(0.5, 0.0, 19.2))
    assert second.figures()["loop_closures"] > before
    assert second.estimate().T_map_base.distance_to(robot.pose) < 0.05


def test_ground_truth_without_a_simulator_says_what_to_use() -> None:
    with pytest.raises(PluginError, match="use kiss_gtsam"):
        GroundTruthSlam(GroundTruthSlam.Options()).setup(RobotContext())


def flat() -> Room:
    """Three rooms in a row with doors between, and furniture at odd places."""
    walls = boxes(
        (-6.0, -2.5, 6.0, 2.5), (-5.0, 1.5, -3.2, 2.5), (3.9, -2.5, 6.0, -1.6), (0.4, 1.9, 1.9, 2.5)
    )
    doors = [[x, y0, x, y1] for x in (-2.0, 2.5) for y0, y1 in ((-2.5, -0.6), (0.5, 2.5))]
    pillars = [[-4.9, -1.7, 0.2], [-2.9, -1.1, 0.12], [-0.9, -1.6, 0.25], [1.7, -1.2, 0.1], [4.6, 1.3, 0.3]]
    return Room(np.vstack((walls.segments, doors)), np.array(pillars))


def through_the_flat(robot: ScriptedRobot) -> Iterable[Measurement]:
    yield from robot.drive(0.5, 0.0, 17.0)
    yield from robot.drive(0.0, 1.0, math.pi)
    yield from robot.drive(0.5, 0.0, 17.0)


def test_a_robot_set_down_elsewhere_finds_itself_in_the_map() -> None:
    robot = ScriptedRobot(flat(), Pose2(-4.2, 0.0, 0.0))
    slam = ready(robot)
    drive(slam, through_the_flat(robot))
    moved = ScriptedRobot(flat(), Pose2(3.5, 0.6, 2.0), seed=1, time_s=robot.time_s)
    drive(slam, moved.drive(0.0, 0.3, 0.5))
    assert slam.estimate().health is not Health.OK
    drive(slam, moved.drive(0.0, 0.3, 6.0))
    assert slam.estimate().health is Health.OK
    assert slam.estimate().T_map_base.distance_to(moved.pose) < 0.10
    drive(slam, moved.drive(0.0, -0.4, 3.0))
    assert slam.estimate().T_map_base.distance_to(moved.pose) < 0.10


def test_a_robot_woken_elsewhere_in_a_saved_map_finds_itself(tmp_path: Path) -> None:
    robot = ScriptedRobot(flat(), Pose2(-4.2, 0.0, 0.0))
    first = ready(robot)
    drive(first, through_the_flat(robot))
    first.save(tmp_path)
    woken = ScriptedRobot(flat(), Pose2(3.5, 0.6, 2.0), seed=1)
    second = KissGtsam(KissGtsam.Options())
    second.setup(RobotContext())
    second.load(tmp_path)
    drive(second, woken.drive(0.0, 0.3, 8.0))
    assert second.estimate().health is Health.OK
    assert second.estimate().T_map_base.distance_to(woken.pose) < 0.10
