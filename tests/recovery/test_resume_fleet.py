"""Fleets that break off, in one process or with a process a robot."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from explore_bt.mission import Solo, load_mission, only_robot
from explore_bt.plugin import load_plugins
from explore_bt.recording import read_recording
from explore_bt.recovery import find_broken_off
from explore_bt.types import Outcome

from .drives import CutAt, drive, resume

ROBOT = """
    driver: {use: sim2d, world: world.yaml, radius: 0.25 m}
    slam: ground_truth
    planner: skeleton
    controller: pursuit
"""
FLEET = f"""\
format: explore-bt/1
name: both
params: {{pause: {{type: duration, default: 0.5 s}}}}
include: [trees.yaml]
robots:
  ada:
    start: [1 m, 2 m, 0 deg]
{ROBOT}
  bob:
    start: [1 m, 1 m, 0 deg]
{ROBOT}
team: {{use: TEAM}}
limits: {{time: 3 min}}
tree: main
"""
CUT_TICK = 62


@pytest.fixture
def fleet(mission: Path, tmp_path: Path) -> Path:
    """Beside the world and the trees of the mission of one robot."""
    for name in ("world.yaml", "trees.yaml"):
        (tmp_path / name).write_text(mission.with_name(name).read_text())
    (tmp_path / "local.yaml").write_text(FLEET.replace("TEAM", "local"))
    (tmp_path / "zenoh.yaml").write_text(FLEET.replace("TEAM", "zenoh, multicast: false"))
    return tmp_path


def test_a_fleet_of_one_process_goes_on_with_its_claims_and_comes_home(fleet: Path) -> None:
    drive(fleet / "local.yaml", fleet / "whole", cut=CutAt(CUT_TICK, fleet / "cut"), stop_at=7.0)
    cuts = find_broken_off(fleet / "cut").run.robots
    assert set(cuts) == {"ada", "bob"}
    assert all(cut.memory.parts["team"]["doing"] == "at work" for cut in cuts.values())
    assert any(cut.memory.parts["team"]["claims"] for cut in cuts.values())
    result = resume(fleet / "cut")
    assert (result.outcome, result.contacts) == (Outcome.EXPLORED, 0)
    assert result.coverage is not None
    assert result.coverage > 0.99
    assert (fleet / "cut" / "map.yaml").exists()
    assert read_recording(fleet / "cut" / "recording.mcap").is_complete


def test_a_robot_of_a_process_of_its_own_is_resumed_alone_and_at_its_pace(fleet: Path) -> None:
    pytest.importorskip("zenoh", reason="eclipse-zenoh is not installed")
    alone = only_robot(load_mission(fleet / "zenoh.yaml", load_plugins().registry), "bob", 3.0)
    drive(alone, fleet / "run", stop_at=5.0)
    broken = find_broken_off(fleet / "run")
    assert broken.mission.solo == Solo("bob", 3.0)
    assert [robot.name for robot in broken.mission.robots] == list(broken.run.robots) == ["bob"]
    resume(fleet / "run")
    found = json.loads((fleet / "run" / "result.json").read_text())
    assert found["outcome"] == "explored"
    assert {"map.yaml", "bob"} <= {each.name for each in (fleet / "run").iterdir()}
    assert (fleet / "run" / "bob" / "map.yaml").exists()
