"""Scans as they are recorded, against the walls that they were cast at."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from explore_bt.mission import load_mission
from explore_bt.plugin import load_plugins
from explore_bt.recording import McapRecorder, Recording, read_recording
from explore_bt.runtime import StopFlag, run_mission
from explore_bt.types import Pose2, Scan2D, Twist2
from tests.groot.box import WORLD

WIDTH_M, HEIGHT_M, WALL_M, NOISE_M = 6.0, 3.0, 0.1, 0.01

TURNING = """
format: explore-bt/1
name: turning
robots:
  robot:
    driver: {use: sim2d, world: box.yaml, radius: 0.2 m}
    slam: {use: ground_truth}
    planner: {use: grid_astar}
    controller: {use: pursuit}
limits: {time: 60 s}
tree: main
trees:
  main:
    sequence:
      - turn: {by: 180 deg}
      - turn: {by: 180 deg}
"""


@pytest.fixture(scope="module")
def turning(tmp_path_factory) -> Recording:
    folder = tmp_path_factory.mktemp("turning")
    (folder / "box.yaml").write_text(WORLD)
    (folder / "mission.yaml").write_text(TURNING)
    registry = load_plugins().registry
    mission = load_mission(folder / "mission.yaml", registry)
    sinks = [McapRecorder(McapRecorder.Options(scan_period=0.1))]
    run_mission(mission, registry=registry, out=folder / "run", seed=0, sinks=sinks, stop=StopFlag())
    return read_recording(folder / "run/recording.mcap")


def returns(scan: Mapping[str, Any]) -> NDArray[np.float64]:
    """(N, 2) metres, ``map`` frame: as Foxglove places them."""
    place, turn = scan["pose"]["position"], scan["pose"]["orientation"]
    ranges = np.array(scan["ranges"], dtype=np.float64)  # null is NaN
    angles = np.linspace(scan["start_angle"], scan["end_angle"], len(ranges))
    angles += 2.0 * math.atan2(turn["z"], turn["w"])
    points = np.column_stack((place["x"] + ranges * np.cos(angles), place["y"] + ranges * np.sin(angles)))
    return points[np.isfinite(ranges)]


def off_the_walls_m(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """How far off the nearest inner face of the box's walls."""
    x, y = np.abs(points[:, 0] - WIDTH_M / 2), np.abs(points[:, 1] - HEIGHT_M / 2)
    to_face = (x - (WIDTH_M - WALL_M) / 2, y - (HEIGHT_M - WALL_M) / 2)
    return np.abs(np.maximum(*to_face))


def test_scans_of_a_turning_robot_lie_on_the_walls_within_noise(turning):
    rates = [message.value["turn_rate_rps"] for message in turning.messages("/robot/state")]
    assert max(map(abs, rates)) > 0.8
    scans = list(turning.messages("/robot/scan"))
    assert len(scans) > 40
    for scan in scans:
        off_m = off_the_walls_m(returns(scan.value))
        assert np.percentile(off_m, 95) < 4 * NOISE_M, f"at {scan.stamp_s} s"


def test_a_scan_is_recorded_from_where_the_robot_was_when_it_ended(recorded_drive, tmp_path):
    tick = recorded_drive.ticks[100]
    seen, robot = Pose2(1.0, 2.0, 0.5), tick.robots[0]
    for told, expected in ((seen, seen), (None, robot.estimate.T_map_base)):
        ticks = [replace(tick, robots=(replace(robot, scan_pose=told),))]
        drive = replace(recorded_drive, ticks=ticks).in_folder(tmp_path)
        drive.show_to(McapRecorder(McapRecorder.Options()))
        (message,) = read_recording(drive.run.folder / "recording.mcap").messages("/robot/scan")
        place = message.value["pose"]["position"]
        there = expected.compose(robot.scan.T_base_sensor)
        assert (place["x"], place["y"]) == pytest.approx(there.xy, abs=1e-3)


@given(st.floats(-0.5, 0.5), st.floats(-1.5, 1.5))
def test_a_sweep_around_a_moving_robot_is_straight_again_to_what_was_driven_across_the_beams(v, w):
    """Of a round room, which the robot crosses while it turns: every beam ends on its wall again."""
    times, angles = np.linspace(-0.1, 0.0, 180), np.linspace(-math.pi, math.pi, 180)
    x, yaw = v * times, w * times  # where the robot was; its turn meanwhile bends the way by micrometres
    along = x * np.cos(yaw + angles)
    ranges = -along + np.sqrt(along**2 + 3.0**2 - x**2)
    scan = Scan2D(1.0, angles, ranges.astype(np.float32), times, 0.05, 10.0)
    straight = np.hypot(*scan.straightened(Twist2(v, w)).points().T)
    assert np.abs(straight - 3.0).max() < 1e-3


def test_what_is_no_range_stays_none_when_a_scan_is_straightened():
    nothing = np.array([np.nan, np.inf, 1.0], dtype=np.float32)
    scan = Scan2D(1.0, np.zeros(3), nothing, np.array([-0.2, -0.1, 0.0]), 0.05, 10.0)
    assert scan.straightened(Twist2(0.5, 1.0)).ranges_m.tolist() == pytest.approx(
        nothing.tolist(), nan_ok=True
    )
