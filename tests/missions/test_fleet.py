"""Missions with several robots, driven to their end by the real parts."""

import itertools
import shutil
from pathlib import Path

import numpy as np
import pytest

from explore_bt.maps import read_map
from explore_bt.mission import load_mission
from explore_bt.plugin import Registry
from explore_bt.runtime import StopFlag, run_mission
from explore_bt.types import Outcome

from .conftest import MISSIONS, RunMission, Watcher

CORRIDOR = """\
format: explore-bt-world/1
rooms:
  - {name: west, box: [0, 0, 4, 4]}
  - {name: corridor, box: [4, 1.5, 12, 2.5]}
  - {name: east, box: [12, 0, 16, 4]}
doors: [{name: w, at: [4, 2], width: 0.9}, {name: e, at: [12, 2], width: 0.9}]
start: [2, 2, 0]
"""
ROBOT = """\
    driver: {use: sim2d, world: corridor.yaml, radius: 0.25 m, lidar_range: 5 m}
    slam: ground_truth
    planner: skeleton
    controller: pursuit
"""
EXPLORE = f"""\
format: explore-bt/1
name: explore
include: [trees/complete.yaml]
robots:
  robot:
{ROBOT}
tree: complete
"""
MEET = f"""\
format: explore-bt/1
name: meet
include: [trees/shared.yaml]
robots:
  ada:
    map: known/slam
    start: [2 m, 2 m, 0 deg]
    tree: {{sequence: [choose_place: {{x: 14, y: 2}}, subtree: reach_goal]}}
{ROBOT}
  bob:
    map: known/slam
    start: [14 m, 2 m, 180 deg]
    tree: {{sequence: [choose_place: {{x: 2, y: 2}}, subtree: reach_goal]}}
{ROBOT}
limits: {{time: 3 min}}
"""


def apart_m(watcher: Watcher) -> float:
    """How near any two robots ever came, edge to edge."""
    gaps = []
    for tick in watcher.ticks:
        poses = [robot.true_pose for robot in tick.robots]
        for one, other in itertools.combinations(poses, 2):
            assert one is not None
            assert other is not None
            gaps.append(one.distance_to(other) - 0.5)
    return min(gaps)


def test_two_robots_divide_the_flat_and_bring_home_one_map(run: RunMission, tmp_path: Path) -> None:
    watcher = Watcher()
    both = run("05_fleet.yaml", "slam=ground_truth", seed=1, sinks=[watcher])
    assert both.outcome is Outcome.EXPLORED
    assert both.contacts == 0
    assert both.coverage is not None
    assert both.coverage >= 0.98
    assert apart_m(watcher) > 0.0
    last = watcher.ticks[-1]
    shares = [np.count_nonzero(robot.grid.free) * 0.05**2 for robot in last.robots]
    merged = read_map(tmp_path / "run" / "map.yaml")
    assert np.count_nonzero(merged.free) * 0.05**2 > 1.05 * max(shares), (
        "each has left something to the other"
    )


def test_the_same_seed_gives_the_same_run_of_all_robots(run: RunMission) -> None:
    ways = []
    for out in ("one", "two"):
        watcher = Watcher()
        run("05_fleet.yaml", "limits.time=25 s", "slam=ground_truth", seed=3, out=out, sinks=[watcher])
        ways.append([robot.true_pose for tick in watcher.ticks for robot in tick.robots])
    assert ways[0] == ways[1]


@pytest.fixture
def corridor(tmp_path: Path) -> Path:
    (tmp_path / "corridor.yaml").write_text(CORRIDOR)
    (tmp_path / "explore.yaml").write_text(EXPLORE)
    (tmp_path / "meet.yaml").write_text(MEET)
    shutil.copytree(MISSIONS / "trees", tmp_path / "trees")
    return tmp_path


def test_face_to_face_in_a_corridor_one_lets_the_other_pass(corridor: Path, registry: Registry) -> None:
    def run(name: str, out: str, watcher: Watcher) -> object:
        mission = load_mission(corridor / name, registry)
        return run_mission(
            mission, registry=registry, out=corridor / out, seed=1, sinks=[watcher], stop=StopFlag()
        )

    run("explore.yaml", "known", Watcher())
    watcher = Watcher()
    result = run("meet.yaml", "met", watcher)
    assert (result.outcome, result.contacts) == (Outcome.EXPLORED, 0)  # type: ignore[attr-defined]  # a Result
    assert apart_m(watcher) > 0.0
    last = {robot.robot: robot.true_pose for robot in watcher.ticks[-1].robots}
    assert last["ada"] is not None
    assert last["bob"] is not None
    assert last["ada"].x > 13.5
    assert last["bob"].x < 2.5
    face_to_face = [
        tick for tick in watcher.ticks if all(_waits_for_mate(r.gate_reason) for r in tick.robots)
    ]
    assert 0 < len(face_to_face) / 10.0 < 10.0, "they met, and not for long"


def _waits_for_mate(reason: str) -> bool:
    return reason.startswith("team mate")
