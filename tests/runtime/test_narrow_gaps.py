"""What the gate is for: a gap about as wide as the robot, tried over and over with a noisy lidar."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from explore_bt import types
from explore_bt.interfaces import ControlStatus, RobotContext, Surroundings
from explore_bt.mission import load_mission
from explore_bt.plugin import Registry, load_plugins
from explore_bt.runtime.pilot import Pilot
from explore_bt.runtime.safety_gate import SafetyGate
from explore_bt.runtime.steadied import steadied
from explore_bt.types import FREE, Estimate, OccupancyGrid, Pose2, Scan2D

WORLD = """
format: explore-bt-world/1
name: gap
start: [0.8, {middle}, 0 deg]
rooms: [{{name: room, box: [0.0, 0.0, 4.0, 3.0]}}]
furniture:
  - {{name: below, box: [1.9, 0.0, {end}, 1.2], height: 2.0}}
  - {{name: above, box: [1.9, {top}, {end}, 3.0], height: 2.0}}
"""
MISSION = """
format: explore-bt/1
name: gap
robots:
  robot: {driver: {use: sim2d, world: world.yaml}, slam: ground_truth, planner: skeleton, controller: pursuit}
limits: {speed: 0.5 m/s}
trees: {still: {wait: {duration: 1 s}}}
tree: still
"""
RADIUS = 0.25
FLOOR = OccupancyGrid(np.full((80, 100), FREE, dtype=np.int8), 0.05, (-0.5, -0.5))
DT = 0.05


@pytest.fixture(scope="module")
def registry() -> Registry:
    return load_plugins().registry


def drive_through(
    registry: Registry, folder: Path, gap_m: float, deep_m: float, pose_noise_m: float, beside_m: float
) -> tuple[float, int]:
    """Drive to and fro through the gap for 40 s; closest clearance in metres, times through."""
    middle = 1.2 + gap_m / 2.0
    (folder / "world.yaml").write_text(WORLD.format(middle=middle, top=1.2 + gap_m, end=1.9 + deep_m))
    (folder / "mission.yaml").write_text(MISSION)
    mission = load_mission(folder / "mission.yaml", registry, [])
    robot = mission.robots[0]
    driver, controller = robot.driver.make(), robot.controller.make()
    driver.setup(RobotContext(robot="robot", seed=0))
    limits = mission.limits.apply(driver.limits)
    controller.setup(RobotContext(robot="robot", seed=0, footprint_radius_m=RADIUS, limits=limits))
    pilot = Pilot(controller, SafetyGate(RADIUS, limits), driver, limits)
    truth = driver.truth()
    assert truth is not None
    rng = np.random.default_rng(0)
    xs = np.arange(0.8, 3.2, 0.05)
    there = np.column_stack((xs, np.full(xs.size, middle + beside_m), np.zeros(xs.size)))
    back = there[::-1] + np.array([0.0, 0.0, math.pi])
    closest_m, times_through = math.inf, 0
    scan: Scan2D | None = None
    estimate = Estimate(0.0, driver.start)
    path = types.Path(there, np.full(xs.size, gap_m / 2.0))
    pilot.follow(path)
    for _ in range(round(40.0 / DT)):
        now_s = driver.clock.now_s()
        for measurement in driver.read():
            if isinstance(measurement, Scan2D):
                scan = measurement
                x, y, yaw = rng.normal(0.0, pose_noise_m, 3) * (1.0, 1.0, 0.3)
                true = truth.pose()
                estimate = Estimate(scan.stamp_s, Pose2(true.x + x, true.y + y, true.yaw_rad + yaw))
                pilot.see(
                    Surroundings(0.0, estimate.T_map_base.apply(steadied(scan).points()), FLOOR), estimate
                )
        pilot.step(estimate, scan, now_s, DT)
        closest_m = min(closest_m, truth.clearance_m())
        if pilot.output.status is ControlStatus.ARRIVED:
            times_through += 1
            path = replace(path, poses=back if times_through % 2 else there)
            pilot.follow(path)
        elif pilot.blocked_s > 1.5:
            pilot.follow(path)
        driver.clock.wait_until(now_s + DT)
    assert truth.contacts() == 0
    return closest_m, times_through


@pytest.mark.parametrize("pose_noise_m", [0.0, 0.004])
@pytest.mark.parametrize("deep_m", [0.02, 0.4])
@pytest.mark.parametrize("gap_m", [0.49, 0.50, 0.51, 0.53, 0.55])
def test_where_it_hardly_fits_it_never_touches(
    registry: Registry, tmp_path: Path, gap_m: float, deep_m: float, pose_noise_m: float
) -> None:
    closest_m, _ = drive_through(registry, tmp_path, gap_m, deep_m, pose_noise_m, beside_m=0.005)
    assert closest_m > RADIUS + 0.002


@pytest.mark.parametrize("pose_noise_m", [0.0, 0.004])
@pytest.mark.parametrize("deep_m", [0.02, 0.4])
def test_where_it_fits_with_three_centimetres_to_spare_on_either_side_it_passes(
    registry: Registry, tmp_path: Path, deep_m: float, pose_noise_m: float
) -> None:
    closest_m, times_through = drive_through(registry, tmp_path, 0.56, deep_m, pose_noise_m, beside_m=0.003)
    assert times_through >= 2
    assert closest_m > RADIUS + 0.02
