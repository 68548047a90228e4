"""What every controller must do, as tests to inherit.

::

    class TestMyController(ControllerContract):
        def make(self):
            return MyController(MyController.Options())
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
import pytest
from numpy.typing import NDArray

from explore_bt.interfaces import API_VERSION, Controller, ControlOutput, ControlStatus, RobotContext
from explore_bt.types import Estimate, MotionLimits, MotionState, Path, Pose2, Twist2, way_along, wrap_angle

__all__ = ["ControllerContract", "KinematicRobot", "cross_track_error", "path_through", "require_limits"]

LIMITS = MotionLimits()
_PERIOD_S = 0.05
_ROUNDING = 1e-6


@dataclass(slots=True)
class KinematicRobot:
    """A unicycle that reaches each command linearly within its period, and remembers what it was sent."""

    pose: Pose2
    motion: MotionState = field(default_factory=MotionState)
    time_s: float = 0.0
    poses: list[Pose2] = field(default_factory=list)
    motions: list[MotionState] = field(default_factory=list)
    outputs: list[ControlOutput] = field(default_factory=list)

    def drive(self, twist: Twist2, dt_s: float) -> None:
        """Obey one command for one period."""
        before = self.motion.twist
        x, y, yaw = self.pose.x, self.pose.y, self.pose.yaw_rad
        pieces = 8
        for k in range(pieces):
            share = (k + 0.5) / pieces
            v = before.linear_mps + share * (twist.linear_mps - before.linear_mps)
            w = before.angular_rps + share * (twist.angular_rps - before.angular_rps)
            h = dt_s / pieces
            x += v * h * math.cos(yaw + 0.5 * w * h)
            y += v * h * math.sin(yaw + 0.5 * w * h)
            yaw += w * h
        self.pose = Pose2(x, y, wrap_angle(yaw))
        self.motion = MotionState(
            twist,
            (twist.linear_mps - before.linear_mps) / dt_s,
            (twist.angular_rps - before.angular_rps) / dt_s,
        )
        self.time_s += dt_s
        self.poses.append(self.pose)
        self.motions.append(self.motion)

    def run(
        self,
        controller: Controller,
        seconds: float,
        until: Callable[[ControlOutput], bool] = lambda output: output.status is not ControlStatus.RUNNING,
        dt_s: float = _PERIOD_S,
    ) -> ControlOutput:
        """Drive by a controller until its output says so, or time is up; returns the last output."""
        end_s = self.time_s + seconds
        while True:
            output = controller.step(Estimate(self.time_s, self.pose), None, self.motion, dt_s)
            self.outputs.append(output)
            self.drive(output.twist, dt_s)
            if until(output) or self.time_s >= end_s:
                return output


def path_through(points: list[tuple[float, float]], final_yaw_rad: float | None = None) -> Path:
    """A smooth path near a polyline, poses 0.1 m apart; its last heading is the path's own if not given."""
    corners = np.array(points, dtype=np.float64)
    along = way_along(corners)
    wanted = np.linspace(0.0, along[-1], max(2, round(along[-1] / 0.02)))
    fine = np.column_stack([np.interp(wanted, along, corners[:, k]) for k in (0, 1)])
    for _ in range(400):  # heat flow rounds the corners and leaves the ends
        fine[1:-1] += 0.25 * (fine[:-2] - 2.0 * fine[1:-1] + fine[2:])
    xy = fine[np.unique(np.append(np.arange(0, len(fine), 5), len(fine) - 1))]
    steps = np.diff(xy, axis=0)
    yaw = np.arctan2(steps[:, 1], steps[:, 0])
    last = yaw[-1] if final_yaw_rad is None else final_yaw_rad
    return Path(np.column_stack((xy, np.append(yaw, last))), np.ones(len(xy)))


def cross_track_error(path: Path, poses: list[Pose2]) -> NDArray[np.float64]:
    """(N,) metres from each pose to the path, taken as straight pieces between its poses."""
    a, step = path.poses[:-1, :2], np.diff(path.poses[:, :2], axis=0)
    square = np.maximum((step * step).sum(axis=1), 1e-18)
    errors = []
    for pose in poses:
        away = np.array(pose.xy) - a
        share = np.clip((away * step).sum(axis=1) / square, 0.0, 1.0)
        errors.append(np.hypot(*(away - share[:, None] * step).T).min())
    return np.array(errors)


_BEND = [(0.0, 0.0), (2.0, 0.0), (2.0, 2.0), (4.0, 2.5)]


class ControllerContract(ABC):
    """Inherit, name it ``Test...`` and give ``make``; the robot is a unicycle under the default limits."""

    @abstractmethod
    def make(self) -> Controller:
        """A controller as a mission would construct it."""

    @pytest.fixture
    def controller(self) -> Controller:
        """The controller under test, set up with the default ``MotionLimits``."""
        controller = self.make()
        controller.setup(RobotContext(limits=LIMITS))
        return controller

    def test_construction_is_cheap_and_names_the_plugin(self) -> None:
        """Missions are checked and drawn without a robot."""
        controller = self.make()
        assert controller.kind == "controller", f"kind is {controller.kind!r}; subclass Controller"
        assert controller.name.isidentifier(), f"name {controller.name!r} is what missions write after 'use:'"
        assert controller.api_version == API_VERSION, (
            f"written for API version {controller.api_version}, this is {API_VERSION}"
        )
        assert isinstance(controller.options, type(controller).Options), "options are not of its Options"

    def test_without_a_path_it_stays_at_rest_and_idle(self, controller: Controller) -> None:
        """Nothing to do, nothing done."""
        robot = KinematicRobot(Pose2(0.0, 0.0, 0.0))
        output = robot.run(controller, 0.5, until=lambda _: False)
        assert output.twist.is_zero, f"step() drives ({output.twist}) though there is no path"
        assert output.status is ControlStatus.IDLE

    def test_a_path_is_driven_to_its_end(self, controller: Controller) -> None:
        """Arrives within 0.15 m and 0.2 rad, at rest, and stays so."""
        path = path_through(_BEND)
        robot = KinematicRobot(Pose2(0.0, 0.0, 0.0))
        controller.follow(path)
        _require_arrival(robot, robot.run(controller, 60.0), path)
        robot.run(controller, 1.0, until=lambda _: False)
        assert robot.outputs[-1].status is ControlStatus.ARRIVED, "an arrival is not taken back"
        assert math.hypot(*_twist(robot)) < 1e-3, f"it still moves after its arrival: {robot.motion.twist}"

    def test_it_stays_near_the_path(self, controller: Controller) -> None:
        """Within 0.15 m on a smooth path."""
        path = path_through(_BEND)
        robot = KinematicRobot(Pose2(0.0, 0.0, 0.0))
        controller.follow(path)
        robot.run(controller, 60.0)
        away = cross_track_error(path, robot.poses)
        assert away.max() <= 0.15, f"it strayed {away.max():.2f} m from the path at step {away.argmax()}"

    @pytest.mark.parametrize("yaw_rad", [0.0, 1.5, math.pi, -2.5])
    def test_limits_are_kept_whatever_the_first_heading(self, controller: Controller, yaw_rad: float) -> None:
        """Velocity, acceleration and jerk, linear and angular, from rest to rest."""
        robot = KinematicRobot(Pose2(0.0, 0.0, yaw_rad))
        controller.follow(path_through(_BEND, final_yaw_rad=-1.0))
        robot.run(controller, 60.0)
        require_limits(robot.motions, LIMITS, [_PERIOD_S] * len(robot.motions))

    @pytest.mark.parametrize("yaw_rad", [2.0, -3.0, 0.5])
    def test_a_path_of_one_pose_is_a_turn_in_place(self, controller: Controller, yaw_rad: float) -> None:
        """It turns to the heading and goes nowhere."""
        robot = KinematicRobot(Pose2(1.0, 2.0, 0.0))
        controller.follow(Path(np.array([[1.0, 2.0, yaw_rad]]), np.ones(1)))
        output = robot.run(controller, 20.0)
        off = abs(wrap_angle(robot.pose.yaw_rad - yaw_rad))
        assert output.status is ControlStatus.ARRIVED, f"status is {output.status}: {output.reason}"
        assert off < 0.2, f"the turn ended {math.degrees(off):.0f}° off"
        moved = robot.pose.distance_to(Pose2(1.0, 2.0, 0.0))
        assert moved < 0.05, f"a turn in place moved the robot by {moved:.2f} m"

    def test_the_final_heading_is_met(self, controller: Controller) -> None:
        """Where the last pose looks elsewhere than the path."""
        path = path_through([(0.0, 0.0), (2.0, 0.0)], final_yaw_rad=2.5)
        robot = KinematicRobot(Pose2(0.0, 0.0, 0.0))
        controller.follow(path)
        _require_arrival(robot, robot.run(controller, 60.0), path)

    def test_hold_brings_the_robot_to_rest(self, controller: Controller) -> None:
        """Under the limits, within three seconds; then the status is idle."""
        robot = KinematicRobot(Pose2(0.0, 0.0, 0.0))
        controller.follow(path_through(_BEND))
        robot.run(controller, 3.0, until=lambda _: False)
        assert robot.motion.twist.linear_mps > 0.1, "it does not drive"
        controller.hold()
        output = robot.run(controller, 3.0, until=lambda o: o.status is ControlStatus.IDLE)
        assert output.status is ControlStatus.IDLE, f"status is {output.status} three seconds after hold()"
        assert math.hypot(*_twist(robot)) < 1e-3, f"idle, but moving: {robot.motion.twist}"
        require_limits(robot.motions, LIMITS, [_PERIOD_S] * len(robot.motions))

    def test_it_goes_on_from_what_was_really_sent(self, controller: Controller) -> None:
        """A brake comes in between; the next command starts from the brake's."""
        robot = KinematicRobot(Pose2(0.0, 0.0, 0.0))
        path = path_through(_BEND)
        controller.follow(path)
        robot.run(controller, 3.0, until=lambda _: False)
        speed, gain = robot.motion.twist.linear_mps, robot.motion.linear_acceleration_mps2
        for _ in range(12):
            controller.step(Estimate(robot.time_s, robot.pose), None, robot.motion, _PERIOD_S)
            gain = max(gain - LIMITS.jerk_mps3 * _PERIOD_S, -LIMITS.acceleration_mps2)
            speed = max(0.0, speed + gain * _PERIOD_S)
            robot.drive(Twist2(speed, 0.0), _PERIOD_S)
        braked = len(robot.motions)
        output = robot.run(controller, 60.0)
        require_limits(robot.motions[braked - 1 :], LIMITS, [_PERIOD_S] * (len(robot.motions) - braked + 1))
        _require_arrival(robot, output, path)

    def test_a_robot_that_does_not_move_is_stuck(self, controller: Controller) -> None:
        """Commands are never obeyed: within 20 s the status is stuck, with a reason."""
        controller.follow(path_through(_BEND))
        pose, output = Pose2(0.0, 0.0, 0.0), None
        for k in range(400):
            output = controller.step(Estimate(k * _PERIOD_S, pose), None, MotionState(), _PERIOD_S)
            if output.status is not ControlStatus.RUNNING:
                break
        assert output is not None
        assert output.status is ControlStatus.STUCK, f"status is {output.status} after 20 s without motion"
        assert output.reason, "stuck without a reason"

    def test_a_robot_far_from_its_path_is_stuck(self, controller: Controller) -> None:
        """Two metres beside it, driving there is a planner's business."""
        robot = KinematicRobot(Pose2(0.0, 2.0, 0.0))
        controller.follow(path_through([(0.0, 0.0), (4.0, 0.0)]))
        output = robot.run(controller, 20.0)
        assert output.status is ControlStatus.STUCK, f"status is {output.status} two metres from the path"
        assert output.reason, "stuck without a reason"

    def test_stuck_comes_to_rest_and_a_new_path_ends_it(self, controller: Controller) -> None:
        """A carried-off robot brakes; the next path is driven."""
        robot = KinematicRobot(Pose2(0.0, 0.0, 0.0))
        controller.follow(path_through([(0.0, 0.0), (6.0, 0.0)]))
        robot.run(controller, 3.0, until=lambda _: False)
        robot.pose = Pose2(robot.pose.x, 3.0, 0.0)
        robot.run(controller, 3.0, until=lambda _: False)
        assert robot.outputs[-1].status is ControlStatus.STUCK
        assert math.hypot(*_twist(robot)) < 1e-3, f"stuck, but moving: {robot.motion.twist}"
        path = path_through([robot.pose.xy, (robot.pose.x + 1.0, robot.pose.y)])
        controller.follow(path)
        _require_arrival(robot, robot.run(controller, 20.0), path)

    def test_a_new_path_is_taken_over_without_a_halt(self, controller: Controller) -> None:
        """It begins where the robot is and where it is going."""
        robot = KinematicRobot(Pose2(0.0, 0.0, 0.0))
        controller.follow(path_through([(0.0, 0.0), (6.0, 0.0)]))
        robot.run(controller, 4.0, until=lambda _: False)
        path = path_through([robot.pose.xy, (robot.pose.x + 2.0, 0.0), (robot.pose.x + 4.0, 2.0)])
        controller.follow(path)
        before = len(robot.motions)
        robot.run(controller, 2.0, until=lambda _: False)
        slowest = min(motion.twist.linear_mps for motion in robot.motions[before:])
        assert slowest > 0.25, f"it slowed to {slowest:.2f} m/s for a path that goes on straight ahead"
        _require_arrival(robot, robot.run(controller, 60.0), path)
        require_limits(robot.motions, LIMITS, [_PERIOD_S] * len(robot.motions))

    def test_the_same_drive_twice_is_the_same(self) -> None:
        """No clock, no chance: two instances give equal commands."""
        drives = []
        for _ in range(2):
            controller = self.make()
            controller.setup(RobotContext(limits=LIMITS))
            robot = KinematicRobot(Pose2(0.0, 0.1, 0.3))
            controller.follow(path_through(_BEND))
            robot.run(controller, 60.0)
            drives.append([motion.twist for motion in robot.motions])
        assert drives[0] == drives[1], "the same inputs gave other commands"


def _twist(robot: KinematicRobot) -> tuple[float, float]:
    return (robot.motion.twist.linear_mps, robot.motion.twist.angular_rps)


def _require_arrival(robot: KinematicRobot, output: ControlOutput, path: Path) -> None:
    assert output.status is ControlStatus.ARRIVED, (
        f"status is {output.status} ({output.reason or 'no reason'}) after {robot.time_s:.0f} s, "
        f"{robot.pose.distance_to(path.goal):.2f} m from the end of the path"
    )
    away = robot.pose.distance_to(path.goal)
    assert away <= 0.15, f"arrived, but {away:.2f} m from the end of the path"
    off = abs(wrap_angle(robot.pose.yaw_rad - path.goal.yaw_rad))
    assert off <= 0.2, f"arrived, but {math.degrees(off):.0f}° off the final heading"


def require_limits(motions: list[MotionState], limits: MotionLimits, periods_s: list[float]) -> None:
    """Velocity, acceleration and jerk; from rest, or from the first motion, which is taken as given.

    Raises:
        AssertionError: names the limit, the step and the value.
    """
    rows: list[tuple[str, str, float, Callable[[MotionState], float]]] = [
        ("speed", "m/s", limits.speed_mps, lambda m: m.twist.linear_mps),
        ("turn rate", "rad/s", limits.turn_rate_rps, lambda m: m.twist.angular_rps),
        ("acceleration", "m/s²", limits.acceleration_mps2, lambda m: m.linear_acceleration_mps2),
        ("turn acceleration", "rad/s²", limits.turn_acceleration_rps2, lambda m: m.angular_acceleration_rps2),
    ]
    for name, unit, limit, read in rows:
        values = np.abs([read(motion) for motion in motions])
        worst = int(values.argmax())
        assert values[worst] <= limit + _ROUNDING, (
            f"{name} {values[worst]:.3f} {unit} at step {worst}; the limit is {limit:.3f} {unit}"
        )
    for name, unit, limit, read in (
        ("jerk", "m/s³", limits.jerk_mps3, rows[2][3]),
        ("turn jerk", "rad/s³", limits.turn_jerk_rps3, rows[3][3]),
    ):
        jerks = np.abs(np.diff([read(motion) for motion in motions])) / np.array(periods_s[1:])
        worst = int(jerks.argmax())
        assert jerks[worst] <= limit + _ROUNDING / min(periods_s), (
            f"{name} {jerks[worst]:.3f} {unit} at step {worst + 1}; the limit is {limit:.3f} {unit}"
        )
