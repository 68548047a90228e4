"""``check --robot``: what is heard, what is missing, what to type."""

from __future__ import annotations

from tests.ros2 import ros  # isort: skip  # noqa: F401

import re
from pathlib import Path
from shutil import copytree

import pytest
from typer.testing import CliRunner

from explore_bt.cli import app
from tests.ros2.worlds import HALL, robot_in

MISSION = str(Path(__file__).parents[2] / "missions/06_ros2.yaml")


def check(*words: str):
    return CliRunner().invoke(app, ["check", MISSION, "--robot", "--listen", "1.5", *words])


def test_a_robot_that_is_not_there_is_told_topic_by_topic_with_what_to_type():
    told = check()
    assert told.exit_code == 1
    assert "fault  /scan                nobody publishes it" in told.output
    assert "ROS_DOMAIN_ID" in told.output
    assert "fault  /cmd_vel             nobody listens" in told.output
    assert "2 faults, no wheel was turned" in told.output


def test_a_robot_that_is_there_is_described_and_wrong_names_are_mended(tmp_path):
    (tmp_path / "hall.yaml").write_text(HALL)
    with robot_in(tmp_path / "hall.yaml", "--wall-time", "--stamped", "--tf-topic", "hall/tf"):
        told = check()
        assert told.exit_code == 1
        assert "→ driver: {tf_topic: /hall/tf}" in told.output
        rate = re.search(r"sensor_msgs/msg/LaserScan, ([\d.]+) Hz, frame laser", told.output)
        assert rate, told.output
        assert float(rate[1]) == pytest.approx(10.0, abs=2.0)  # of few scans, on a machine with other work
        assert "best_effort volatile" in told.output
        assert "the base listens to geometry_msgs/msg/TwistStamped" in told.output
        assert "→ driver: {stamped: true}" in told.output

        mission = tmp_path / "mine.yaml"
        text = Path(MISSION).read_text()
        changed = "use: ros2, stamped: true, scan_topic: front/scan, reliability: reliable"
        mission.write_text(text.replace("use: ros2", changed))
        copytree(Path(MISSION).parent / "trees", tmp_path / "trees")
        told = CliRunner().invoke(app, ["check", str(mission), "--robot", "--listen", "1.5"])
        assert told.exit_code == 1
        assert "→ driver: {scan_topic: /scan}" in told.output
        assert "QoS mismatch: the other side offers another reliability" in told.output
        assert "1 listening" in told.output


def test_a_lidar_that_is_too_slow_for_the_silence_allowed_is_told_with_what_to_set(tmp_path):
    (tmp_path / "hall.yaml").write_text(HALL)
    mission = tmp_path / "slow.yaml"
    text = Path(MISSION).read_text()
    mission.write_text(text.replace("driver: {use: ros2,", "driver: {use: ros2, silence: 0.1 s,"))
    copytree(Path(MISSION).parent / "trees", tmp_path / "trees")
    with robot_in(tmp_path / "hall.yaml", "--wall-time"):
        told = CliRunner().invoke(app, ["check", str(mission), "--robot", "--listen", "1.5"])
    assert told.exit_code == 1
    assert re.search(r"Hz is slow for driving: set silence: 0\.[12]\d s", told.output), told.output
