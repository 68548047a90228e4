"""Scans as they are recorded, against the walls that they were cast at."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from explore_bt.mission import load_mission
from explore_bt.plugin import load_plugins
from explore_bt.recording import McapRecorder, Recording, read_recording
from explore_bt.runtime import StopFlag, run_mission
from tests.groot.box import WORLD

WIDTH_M, HEIGHT_M, NOISE_M = 6.0, 3.0, 0.01

TURNING = f"""
format: explore-bt/1
name: turning
robots:
  robot:
    driver: {{use: sim2d, world: box.yaml, radius: 0.2 m}}
    slam: {{use: ground_truth}}
    planner: {{use: grid_astar}}
    controller: {{use: pursuit}}
limits: {{time: 60 s}}
tree: main
trees:
  main:
    sequence:
      - turn: {{by: 180 deg}}
      - turn: {{by: 180 deg}}
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
    x, y = np.abs(points[:, 0] - WIDTH_M / 2), np.abs(points[:, 1] - HEIGHT_M / 2)
    return np.minimum(np.abs(x - WIDTH_M / 2), np.abs(y - HEIGHT_M / 2))


def test_scans_of_a_turning_robot_lie_on_the_walls(turning):
    rates = {round(m.stamp_s, 3): m.value["turn_rate_rps"] for m in turning.messages("/robot/state")}
    assert max(rates.values()) > 0.8
    off_m = [off_the_walls_m(returns(scan.value)) for scan in turning.messages("/robot/scan")]
    assert len(off_m) > 40
    print(max(rates.values()), len(off_m), np.percentile(np.concatenate(off_m), [50, 90, 99, 100]), max(np.median(x) for x in off_m), max(np.percentile(x, 95) for x in off_m))
