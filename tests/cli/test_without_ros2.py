"""Where ROS 2 is not installed: what is said, and what is not."""

from __future__ import annotations

import importlib.util
from pathlib import Path

import pytest
from typer.testing import CliRunner

from explore_bt.cli import app

MISSIONS = Path(__file__).parents[2] / "missions"
LINE = 'pip install "explore-bt[ros2]"'


pytestmark = pytest.mark.skipif(
    importlib.util.find_spec("rclpy") is not None, reason="ROS 2 is installed here: it is not missing"
)


def one_line(text: str) -> str:
    return " ".join(text.split())


def test_the_list_of_plugins_names_the_line_to_type():
    shown = CliRunner().invoke(app, ["plugins"])
    assert shown.exit_code == 0
    assert "left out  ros2" in shown.output
    assert LINE in one_line(shown.output)


def test_a_mission_on_ros2_names_it_too():
    refused = CliRunner().invoke(app, ["check", str(MISSIONS / "06_ros2.yaml")])
    assert refused.exit_code == 2
    assert 'no driver is called "ros2"' in refused.output
    assert LINE in one_line(refused.output)


def test_the_trial_robot_names_it_too():
    refused = CliRunner().invoke(app, ["ros2-sim", str(MISSIONS / "00_room.yaml")])
    assert refused.exit_code == 2
    assert LINE in one_line(refused.output)


def test_a_mistyped_name_is_not_blamed_on_ros2(tmp_path):
    text = (MISSIONS / "00_room.yaml").read_text().replace("use: skeleton", "use: skeletn")
    (tmp_path / "mine.yaml").write_text(text)
    refused = CliRunner().invoke(app, ["check", str(tmp_path / "mine.yaml")])
    assert refused.exit_code == 2
    assert 'did you mean "skeleton"' in refused.output
    assert "ros2" not in refused.output
