from __future__ import annotations

import math

import numpy as np
from explore_bt_slam import KissGtsam
from explore_bt_slam.seen_step import fuse_step
from explore_bt_slam.sight_match import SightMatch
from hypothesis import given
from hypothesis import strategies as st

from explore_bt.interfaces import RobotContext
from explore_bt.testing.slam_camera import RoomCamera, filmed
from explore_bt.testing.slam_room import Room, ScriptedRobot
from explore_bt.types import Imu, Pose2

sigmas = st.tuples(st.floats(0.1, 0.5), *[st.floats(0.01, 0.09)] * 2)
small = st.floats(-0.05, 0.05)


@given(ours=sigmas, theirs=sigmas, off=st.tuples(small, small, small), yaw_rad=st.floats(-3.0, 3.0))
def test_the_fused_step_is_the_information_weighted_mean(ours, theirs, off, yaw_rad):
    relative = Pose2(0.5, 0.1, yaw_rad)
    seen = Pose2(relative.x + off[0], relative.y + off[1], relative.yaw_rad + off[2])
    covariance, spread = np.diag(ours) ** 2, np.diag(theirs) ** 2
    fused = fuse_step(relative, covariance, SightMatch(seen, spread, 20))
    if fused is None:
        return
    c, s = math.cos(yaw_rad), math.sin(yaw_rad)
    turn = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    one, other = turn @ np.linalg.inv(covariance) @ turn.T, np.linalg.inv(spread)
    mean = np.linalg.solve(one + other, one @ np.zeros(3) + other @ np.array(off))
    step, left = fused
    np.testing.assert_allclose(
        [step.x - relative.x, step.y - relative.y, math.remainder(step.yaw_rad - yaw_rad, math.tau)],
        mean,
        atol=1e-9,
    )
    np.testing.assert_allclose(np.linalg.inv(left), turn.T @ (one + other) @ turn, rtol=1e-6, atol=1e-6)


def test_a_camera_that_contradicts_the_lidar_is_not_heard():
    sure = np.diag([0.01, 0.01, 0.005]) ** 2
    assert fuse_step(Pose2(0.5, 0, 0), sure, SightMatch(Pose2(1.2, 0, 0), sure, 20)) is None


def misled(measured):
    """An accelerometer that feels 0.06 m/s² which are not there."""
    for each in measured:
        if isinstance(each, Imu):
            x, y, z = each.linear_acceleration_mps2
            yield Imu(each.stamp_s, each.angular_velocity_rps, (x + 0.06, y, z))
        else:
            yield each


def test_the_camera_tells_how_far_a_plain_corridor_goes():
    """20 m between two walls; without the camera the accelerometer leads astray by decimetres."""
    room = Room(
        np.array([[-1.0, 1.0, 40.0, 1.0], [-1.0, -1.0, 40.0, -1.0], [-1.0, -1.0, -1.0, 1.0]]),
        np.zeros((0, 3)),
    )
    off = []
    for camera_closures in (True, False):
        robot = ScriptedRobot(room, Pose2(0.0, 0.0, 0.0))
        camera = RoomCamera(room, np.arange(3))
        slam = KissGtsam(KissGtsam.Options(camera_closures=camera_closures))
        slam.setup(RobotContext(start=robot.pose))
        for measurement in filmed(robot, camera, misled(robot.drive(0.5, 0.0, 40.0))):
            slam.update(measurement)
        off.append(slam.estimate().T_map_base.distance_to(robot.pose))
    assert off[0] < 0.35
    assert off[0] < 0.5 * off[1]
