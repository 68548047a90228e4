"""The four templates of a stack, driving together: what new-plugin writes is a robot that works."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import pytest

from explore_bt.cli.templates import controller, driver, planner, slam
from explore_bt.interfaces import ControlStatus, RobotContext
from explore_bt.types import MotionState, Path, Pose2

DT_S = 0.05


@dataclass
class Drive:
    """One robot of four templates, stepped by hand."""

    driver: driver.MyPlugin = field(default_factory=lambda: driver.MyPlugin(driver.MyPlugin.Options()))
    slam: slam.MyPlugin = field(default_factory=lambda: slam.MyPlugin(slam.MyPlugin.Options(size=10.0)))
    planner: planner.MyPlugin = field(default_factory=lambda: planner.MyPlugin(planner.MyPlugin.Options()))
    controller: controller.MyPlugin = field(
        default_factory=lambda: controller.MyPlugin(controller.MyPlugin.Options())
    )
    motion: MotionState = MotionState()
    now_s: float = 0.0

    def __post_init__(self) -> None:
        context = RobotContext(start=Pose2(-1.0, 0.5, 1.0))
        for part in (self.driver, self.slam, self.planner, self.controller):
            part.setup(context)
        self.sense()
        self.sense()

    def sense(self) -> None:
        self.now_s += DT_S
        self.driver.clock.wait_until(self.now_s)
        for measurement in self.driver.read():
            self.slam.update(measurement)

    def step(self) -> ControlStatus:
        output = self.controller.step(self.slam.estimate(), None, self.motion, DT_S)
        linear, angular = output.twist.linear_mps, output.twist.angular_rps
        self.motion = MotionState(
            output.twist,
            (linear - self.motion.twist.linear_mps) / DT_S,
            (angular - self.motion.twist.angular_rps) / DT_S,
        )
        self.driver.command(output.twist)
        self.sense()
        return output.status

    def until(self, status: ControlStatus, seconds: float) -> None:
        for _ in range(round(seconds / DT_S)):
            if self.step() is status:
                return
        pytest.fail(f"not {status} after {seconds} s")

    def plan(self, goal: Pose2) -> Path:
        return self.planner.plan(self.slam.grid(), self.slam.estimate().T_map_base, goal, 0.25)


@pytest.mark.parametrize("goal", [Pose2(1.5, -0.8, 0.0), Pose2(-2.2, -1.2, -2.0)])
def test_it_maps_plans_drives_and_arrives_facing_the_way_it_should(goal):
    drive = Drive()
    drive.controller.follow(drive.plan(goal))
    drive.until(ControlStatus.ARRIVED, 60.0)
    pose = drive.slam.estimate().T_map_base
    assert pose.distance_to(goal) < 0.08
    assert abs(math.remainder(pose.yaw_rad - goal.yaw_rad, math.tau)) < 0.06
    assert drive.motion.twist.is_zero


def test_the_map_shows_the_room():
    drive = Drive()
    grid = drive.slam.grid()
    assert grid.value_at(-2.5, 1.5) == 0
    assert 100 in (grid.value_at(-3.02, 0.5), grid.value_at(-2.98, 0.5))
    assert grid.value_at(-3.2, 0.5) == -1
    # 6 m × 4 m, of which the lidar sees 5 m around the start
    assert 20.0 < grid.free.sum() * grid.resolution_m**2 < 24.0
