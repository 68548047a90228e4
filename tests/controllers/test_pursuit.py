import math
from dataclasses import replace

import numpy as np
import pytest
from explore_bt_controllers import Pursuit
from explore_bt_controllers.track import legs_of
from explore_bt_controllers.turning import Turn
from hypothesis import given, settings
from hypothesis import strategies as st

from explore_bt.interfaces import ControlStatus, RobotContext
from explore_bt.testing.controller_contract import KinematicRobot, cross_track_error, path_through
from explore_bt.types import Estimate, MotionLimits, MotionState, Path, Pose2, Twist2, wrap_angle

LIMITS = MotionLimits()


def pursuit(limits=LIMITS, **options):
    controller = Pursuit(Pursuit.Options(**options))
    controller.setup(RobotContext(limits=limits))
    return controller


def random_path(rng, pieces=5):
    points, heading = [(0.0, 0.0)], 0.0
    for _ in range(pieces):
        heading += rng.uniform(-1.4, 1.4)
        step = rng.uniform(0.8, 2.0)
        x, y = points[-1]
        points.append((x + step * math.cos(heading), y + step * math.sin(heading)))
    return path_through(points)


def step(controller, robot, dt):
    output = controller.step(Estimate(robot.time_s, robot.pose), None, robot.motion, dt)
    before = robot.motion
    robot.drive(output.twist, dt)
    return output, before, robot.motion


@settings(deadline=None, max_examples=25)
@given(st.integers(0, 10_000), st.data())
def test_limits_hold_on_any_path_at_any_period_even_when_they_are_cut(seed, data):
    rng = np.random.default_rng(seed)
    controller, limits = pursuit(), LIMITS
    path = random_path(rng)
    robot = KinematicRobot(Pose2(0.0, 0.0, float(rng.uniform(-3.0, 3.0))))
    controller.follow(path)
    cut_at = data.draw(st.integers(20, 200))
    share = data.draw(st.floats(0.3, 1.0))
    for k in range(400):
        if k == cut_at:
            limits = MotionLimits(*(share * value for value in vars_of(LIMITS)))
            controller.limit(limits)
        dt = float(rng.uniform(0.02, 0.1))
        output, before, after = step(controller, robot, dt)
        check_step(before, after, limits, dt)
        if output.status is not ControlStatus.RUNNING:
            break
    assert output.status is not ControlStatus.STUCK, output.reason


def vars_of(limits):
    return [getattr(limits, name) for name in MotionLimits.__slots__]


def check_step(before, after, limits, dt):
    """Limits, or on the way back under them where they were cut: then never further out."""
    rows = (
        (
            before.twist.linear_mps,
            after.twist.linear_mps,
            before.linear_acceleration_mps2,
            after.linear_acceleration_mps2,
            limits.speed_mps,
            limits.acceleration_mps2,
            limits.jerk_mps3,
        ),
        (
            before.twist.angular_rps,
            after.twist.angular_rps,
            before.angular_acceleration_rps2,
            after.angular_acceleration_rps2,
            limits.turn_rate_rps,
            limits.turn_acceleration_rps2,
            limits.turn_jerk_rps3,
        ),
    )
    for v0, v1, a0, a1, top, acceleration, jerk in rows:
        assert abs(a1 - a0) <= jerk * dt + 1e-6
        assert abs(a1) <= max(acceleration, abs(a0) - jerk * dt) + 1e-6
        coasting = abs(v0) + a0 * a0 / (2.0 * jerk)  # what the cut jerk cannot take back any more
        assert abs(v1) <= max(top, coasting) + 1e-6


def test_smooth_paths_are_tracked_within_three_centimetres_on_average():
    rng = np.random.default_rng(1)
    controller = pursuit()
    worst = []
    for _ in range(25):
        path = random_path(rng)
        robot = KinematicRobot(Pose2(0.0, 0.0, float(path.poses[0, 2])))
        controller.follow(path)
        assert robot.run(controller, 120.0).status is ControlStatus.ARRIVED
        worst.append(cross_track_error(path, robot.poses).max())
    assert np.mean(worst) <= 0.03
    assert max(worst) <= 0.08


def test_a_robot_that_holds_each_command_is_tracked_as_well():
    path = path_through([(0.0, 0.0), (2.0, 0.0), (2.0, 2.0), (4.0, 2.5)])
    controller, pose, motion, dt, seen = pursuit(), Pose2(0.0, 0.0, 0.0), MotionState(), 0.05, []
    controller.follow(path)
    for _ in range(600):
        twist = controller.step(Estimate(0.0, pose), None, motion, dt).twist
        motion = MotionState(
            twist,
            (twist.linear_mps - motion.twist.linear_mps) / dt,
            (twist.angular_rps - motion.twist.angular_rps) / dt,
        )
        yaw = pose.yaw_rad + 0.5 * twist.angular_rps * dt
        pose = Pose2(
            pose.x + twist.linear_mps * dt * math.cos(yaw),
            pose.y + twist.linear_mps * dt * math.sin(yaw),
            pose.yaw_rad + twist.angular_rps * dt,
        )
        seen.append(pose)
    assert cross_track_error(path, seen).max() < 0.05
    assert pose.distance_to(path.goal) < 0.08


def test_sharp_bends_are_turned_in_place():
    corners = np.array([[0.0, 0.0, 0.0], [1.5, 0.0, 0.0], [1.5, 1.5, math.pi / 2], [0.0, 1.5, math.pi]])
    assert len(legs_of(corners, math.radians(50))) == 3
    path = Path(corners, np.ones(4))
    controller, robot = pursuit(), KinematicRobot(Pose2(0.0, 0.0, 0.0))
    controller.follow(path)
    assert robot.run(controller, 60.0).status is ControlStatus.ARRIVED
    assert cross_track_error(path, robot.poses).max() < 0.03


def test_the_bends_of_a_raw_grid_path_are_driven():
    xy = np.array([(0.1 * k, 0.0) for k in range(11)] + [(1.0 + 0.07 * k, 0.07 * k) for k in range(1, 12)])
    yaw = np.arctan2(*np.diff(xy, axis=0).T[::-1])
    path = Path(np.column_stack((xy, np.append(yaw, yaw[-1]))), np.ones(len(xy)))
    controller, robot = pursuit(), KinematicRobot(Pose2(0.0, 0.0, 0.0))
    controller.follow(path)
    assert robot.run(controller, 60.0).status is ControlStatus.ARRIVED
    assert cross_track_error(path, robot.poses).max() < 0.06


def test_a_path_that_crosses_itself_is_driven_in_order():
    t = np.linspace(0.0, 2.0 * math.pi, 120)
    xy = np.column_stack((2.0 * np.sin(t), 1.5 * np.sin(2.0 * t)))
    steps = np.diff(xy, axis=0)
    yaw = np.arctan2(steps[:, 1], steps[:, 0])
    path = Path(np.column_stack((xy, np.append(yaw, yaw[-1]))), np.ones(len(xy)))
    controller, robot = pursuit(), KinematicRobot(Pose2(0.0, 0.0, float(yaw[0])))
    controller.follow(path)
    assert robot.run(controller, 120.0).status is ControlStatus.ARRIVED
    driven = sum(a.distance_to(b) for a, b in zip(robot.poses[:-1], robot.poses[1:], strict=True))
    assert driven == pytest.approx(path.length_m, rel=0.03)


def test_jumps_of_the_estimate_by_a_few_centimetres_are_taken_back_in_peace():
    rng = np.random.default_rng(2)
    path = path_through([(0.0, 0.0), (3.0, 0.0), (3.0, 3.0)])
    controller, robot = pursuit(), KinematicRobot(Pose2(0.0, 0.0, 0.0))
    controller.follow(path)
    shift, output = np.zeros(2), None
    for k in range(800):
        if k % 20 == 0:
            shift = rng.uniform(-0.04, 0.04, size=2)
        seen = Pose2(robot.pose.x + shift[0], robot.pose.y + shift[1], robot.pose.yaw_rad)
        output = controller.step(Estimate(robot.time_s, seen), None, robot.motion, 0.05)
        before = robot.motion
        robot.drive(output.twist, 0.05)
        check_step(before, robot.motion, LIMITS, 0.05)
        if output.status is not ControlStatus.RUNNING:
            break
    assert output.status is ControlStatus.ARRIVED
    assert cross_track_error(path, robot.poses).max() < 0.12


def test_a_goal_that_was_missed_is_approached_again():
    path = path_through([(0.0, 0.0), (2.0, 0.0)], final_yaw_rad=1.0)
    controller, robot = pursuit(), KinematicRobot(Pose2(0.0, 0.0, 0.0))
    controller.follow(path)
    robot.run(controller, 60.0, until=lambda _: path.goal.distance_to(robot.pose) < 0.05)
    robot.pose = replace(robot.pose, y=robot.pose.y + 0.2)  # SLAM corrects itself
    output = robot.run(controller, 60.0)
    assert output.status is ControlStatus.ARRIVED
    assert robot.pose.distance_to(path.goal) <= 0.08
    assert abs(wrap_angle(robot.pose.yaw_rad - 1.0)) <= 0.15


@pytest.mark.parametrize("seed", range(6))
def test_an_estimate_that_flickers_does_not_keep_the_robot_from_arriving(seed):
    rng = np.random.default_rng(seed)
    path = path_through([(0.0, 0.0), (1.5, 0.0), (1.5, 1.5)], final_yaw_rad=-2.0)
    controller, robot = pursuit(), KinematicRobot(Pose2(0.0, 0.0, 0.0))
    controller.follow(path)
    for _ in range(800):
        x, y, yaw = rng.normal(robot.pose.as_array(), (0.01, 0.01, 0.01))
        output = controller.step(Estimate(0.0, Pose2(x, y, yaw)), None, robot.motion, 0.05)
        robot.drive(output.twist, 0.05)
        if output.status is not ControlStatus.RUNNING:
            break
    assert output.status is ControlStatus.ARRIVED
    assert robot.time_s < 25.0
    assert robot.pose.distance_to(path.goal) < 0.1


def test_a_turn_of_half_a_circle_keeps_its_direction_though_the_heading_flickers():
    turn = Turn(math.pi)
    first = turn.remaining(0.01)
    for flicker in (-0.02, 0.02, -0.03, 0.01):
        assert math.copysign(1.0, turn.remaining(flicker)) == math.copysign(1.0, first)


def test_a_turn_in_place_takes_little_longer_than_the_limits_demand():
    controller, robot = pursuit(), KinematicRobot(Pose2(0.0, 0.0, 0.0))
    controller.follow(Path(np.array([[0.0, 0.0, math.pi / 2]]), np.ones(1)))
    robot.run(controller, 20.0)
    # ramps: 0.6 s at 2 rad/s², jerk 0.25 s each
    assert robot.time_s < 1.35 * (math.pi / 2 / 1.2 + 1.2 / 2.0 + 2.0 / 8.0)
    assert abs(wrap_angle(robot.pose.yaw_rad - math.pi / 2)) < 0.03


def test_no_progress_and_being_off_the_path_are_told_apart_in_words():
    path = path_through([(0.0, 0.0), (3.0, 0.0)])
    controller = pursuit(stuck_after=2.0)
    controller.follow(path)
    for _ in range(60):
        output = controller.step(Estimate(0.0, Pose2(0.0, 0.0, 0.0)), None, MotionState(), 0.05)
    assert (output.status, output.reason) == (ControlStatus.STUCK, "no progress for 2.0 s")
    controller.follow(path)
    output = controller.step(Estimate(0.0, Pose2(1.0, 0.8, 0.0)), None, MotionState(), 0.05)
    assert output.status is ControlStatus.STUCK
    assert output.reason == "0.80 m off the path, 0.50 m is allowed"


def test_driving_backwards_by_a_foreign_command_is_led_back_to_forward_motion():
    controller, robot = pursuit(), KinematicRobot(Pose2(1.0, 0.0, 0.0), MotionState(Twist2(-0.2, 0.0)))
    controller.follow(path_through([(0.0, 0.0), (3.0, 0.0)]))
    assert robot.run(controller, 30.0).status is ControlStatus.ARRIVED
    for before, after in zip(robot.motions[:-1], robot.motions[1:], strict=True):
        check_step(before, after, LIMITS, 0.05)
