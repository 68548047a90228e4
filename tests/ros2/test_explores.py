"""Two processes: a robot on ROS 2 and a mission that knows its topics only."""

from __future__ import annotations

from tests.ros2 import ros  # isort: skip  # noqa: F401

import json
from pathlib import Path

import pytest

from explore_bt.exploration import CoverageMeter
from explore_bt.interfaces import RobotContext
from explore_bt.maps import read_map
from explore_bt.plugin import load_plugins
from explore_bt.types import Pose2
from tests.ros2.processes import Process
from tests.ros2.worlds import robot_in

MISSIONS = Path(__file__).parents[2] / "missions"
START = Pose2(3.3, 3.6, 0.0)


def coverage_of(folder: Path) -> float:
    """Share of the apartment's floor that can be seen which a run's map holds."""
    sim2d = load_plugins().registry.get("driver", "sim2d")
    driver = sim2d(sim2d.Options(world=MISSIONS / "worlds/apartment.yaml", radius=0.25, lidar_range=5.0))
    driver.setup(RobotContext(start=START))
    return CoverageMeter(driver.truth().observable_floor()).measure(read_map(folder / "map.yaml"))


@pytest.mark.slow
def test_the_apartment_is_explored_over_topics_at_three_times_the_speed_of_real_time(tmp_path):
    start = f"start=[{START.x} m, {START.y} m, 0 deg]"
    truth = tmp_path / "truth.json"
    sim = ["--seed", "1", "--speed", "3", "--set", start, "--out", truth]
    with robot_in(MISSIONS / "01_apartment.yaml", *sim):
        words = ["run", MISSIONS / "06_ros2.yaml", "--set", "sim=true", "--set", start]
        with Process(*words, "--headless", "--out", tmp_path / "run") as mission:
            code = mission.finish(deadline_s=300.0)
    assert code == 0, mission.text
    assert coverage_of(tmp_path / "run") >= 0.98
    assert json.loads(truth.read_text())["contacts"] == 0
