"""Every shipped mission, driven to its end by the real parts."""

import json
import os
import re
import shutil
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from explore_bt.cli import app
from explore_bt.interfaces import PluginOptions, RunInfo, Sink, TickSnapshot
from explore_bt.maps import read_map
from explore_bt.plugin import Registry
from explore_bt.runtime import StopFlag
from explore_bt.types import Outcome, Result

from .conftest import MISSIONS, RunMission

FIGURES = {
    "outcome",
    "reason",
    "coverage",
    "contacts",
    "touched_by_people",
    "ate_rmse_m",
    "path_length_m",
    "mission_time_s",
    "wall_time_s",
    "min_clearance_m",
    "mean_clearance_m",
    "distance_to_home_m",
    "seed",
    "mission_sha256",
    "version",
}


def all_sinks(registry: Registry) -> list[Sink]:
    return [registry.get("sink", name)(registry.get("sink", name).Options()) for name in ("mcap", "report")]


def test_the_room_is_explored_with_real_slam_and_leaves_whole_files(
    run: RunMission, registry: Registry, tmp_path: Path
) -> None:
    result = run("00_room.yaml", seed=1, sinks=all_sinks(registry))
    assert result.outcome is Outcome.EXPLORED
    assert result.coverage is not None
    assert result.coverage >= 0.98
    assert result.contacts == 0
    assert result.ate_rmse_m is not None
    assert result.ate_rmse_m <= 0.05
    assert result.distance_to_home_m < 0.2
    out = tmp_path / "run"
    names = {path.name for path in out.iterdir()}
    assert names >= {
        "map.pgm",
        "map.yaml",
        "graph.g2o",
        "trajectory.tum",
        "truth.tum",
        "recording.mcap",
        "report.html",
        "result.json",
    }
    assert all(path.stat().st_size > 0 for path in out.iterdir())
    assert json.loads((out / "result.json").read_text()).keys() >= FIGURES
    assert read_map(out / "map.yaml").free.any()


def test_the_same_mission_and_seed_give_the_same_run_bit_for_bit(
    run: RunMission, registry: Registry, tmp_path: Path
) -> None:
    for out in ("first", "second"):
        run("00_room.yaml", seed=4, out=out, sinks=all_sinks(registry))
    for name in ("trajectory.tum", "truth.tum", "map.pgm", "recording.mcap"):
        assert (tmp_path / "first" / name).read_bytes() == (tmp_path / "second" / name).read_bytes()


def test_another_seed_gives_another_run(run: RunMission, tmp_path: Path) -> None:
    for seed in (1, 2):
        run("00_room.yaml", "slam=ground_truth", seed=seed, out=str(seed))
    truths = [(tmp_path / str(seed) / "truth.tum").read_bytes() for seed in (1, 2)]
    assert truths[0] != truths[1]


@pytest.mark.slow
def test_the_apartment_is_explored_and_the_robot_comes_home(run: RunMission) -> None:
    result = run("01_apartment.yaml", seed=0)
    assert result.outcome is Outcome.EXPLORED
    assert result.coverage is not None
    assert result.coverage >= 0.98
    assert result.contacts == 0
    assert result.ate_rmse_m is not None
    assert result.ate_rmse_m <= 0.05
    assert result.distance_to_home_m < 0.2


@pytest.mark.slow
@pytest.mark.parametrize("name", ["ros/aws_small_house", "kth/50052751"])
def test_the_same_tree_explores_a_real_building(run: RunMission, name: str) -> None:
    data = os.environ.get("EXPLORE_BT_DATA")
    if not data:
        pytest.skip("EXPLORE_BT_DATA is not set: the real floor plans are not here")
    world = Path(data) / "floorplans" / f"{name}.yaml"
    result = run("02_any_map.yaml", f"world={world}", "slam=ground_truth")
    assert result.outcome is Outcome.EXPLORED
    assert result.contacts == 0
    assert result.coverage is not None
    assert result.coverage >= 0.97


def test_the_paper_s_own_tree_ends_by_naming_its_live_lock(run: RunMission, tmp_path: Path) -> None:
    mission = (MISSIONS / "00_room.yaml").read_text()
    text = mission.replace("complete", "paper").replace("worlds/", f"{MISSIONS}/worlds/")
    shutil.copytree(MISSIONS / "trees", tmp_path / "trees")
    (tmp_path / "mission.yaml").write_text(text)
    result = run(tmp_path / "mission.yaml", "slam=ground_truth")
    assert result.outcome is Outcome.FAILED
    assert "live-lock: 40 decisions brought" in result.reason
    assert result.contacts == 0


class StopAfter(Sink):
    """Raises the stop flag at a mission time and counts the ticks the robot still moves faster after it."""

    name = "stop_after"
    api_version = 1

    def __init__(self, stop: StopFlag, time_s: float) -> None:
        super().__init__(PluginOptions())
        self._stop = stop
        self._time_s = time_s
        self.speeds: list[float] = []

    def open(self, run: RunInfo) -> None: ...

    def on_tick(self, tick: TickSnapshot) -> None:
        if tick.stamp_s >= self._time_s:
            self._stop.raise_flag("the test said so")
            self.speeds.append(abs(tick.robots[0].motion.twist.linear_mps))

    def close(self, result: Result | None) -> None: ...


def test_the_stop_flag_brakes_within_a_tick_and_keeps_the_results(run: RunMission, tmp_path: Path) -> None:
    stop = StopFlag()
    watcher = StopAfter(stop, 8.0)
    result = run("00_room.yaml", "slam=ground_truth", sinks=[watcher], stop=stop)
    assert result.outcome is Outcome.STOPPED
    assert result.reason == "the test said so"
    assert watcher.speeds[-1] < 1e-3
    assert all(later <= earlier + 0.03 for earlier, later in pairwise(watcher.speeds[1:]))
    assert result.mission_time_s < 12.0
    assert (tmp_path / "run/map.pgm").stat().st_size > 0


def test_who_walks_into_a_robot_that_stands_is_counted_apart_from_contacts(
    run: RunMission, tmp_path: Path
) -> None:
    (tmp_path / "world.yaml").write_text(
        "format: explore-bt-world/1\nstart: [2 m, 1.5 m, 0]\nrooms: [{name: hall, box: [0, 0, 4, 3]}]\n"
        "people: [{name: ada, route: [[0.5, 1.5], [3.5, 1.5]], pause: 1 s}]\n"
    )
    (tmp_path / "mission.yaml").write_text(
        "format: explore-bt/1\nrobots:\n  robot: {driver: {use: sim2d, world: world.yaml},"
        " slam: ground_truth, planner: skeleton, controller: pursuit}\n"
        "tree: {wait: {duration: 3.2 s}}\n"
    )
    result = run(tmp_path / "mission.yaml")
    assert (result.contacts, result.touched_by_people) == (0, 1)
    assert json.loads((tmp_path / "run/result.json").read_text())["touched_by_people"] == 1


def test_a_spent_time_budget_ends_the_mission_at_rest(run: RunMission) -> None:
    result = run("00_room.yaml", "slam=ground_truth", "limits.time=6 s")
    assert result.outcome is Outcome.BUDGET
    assert result.reason == "the time budget of 6 s is spent"


def test_a_spent_distance_budget_ends_the_mission(run: RunMission) -> None:
    result = run("00_room.yaml", "slam=ground_truth", "strategy=paper", "limits.distance=1.5 m")
    assert result.outcome is Outcome.BUDGET
    assert "distance budget" in result.reason
    assert 1.5 <= result.path_length_m < 2.5


@pytest.mark.parametrize("limit", ["time: 70 s", "distance: 25 m", "battery: 20 %"])
def test_a_robot_turns_home_while_what_is_left_lasts(run: RunMission, tmp_path: Path, limit: str) -> None:
    missions = shutil.copytree(MISSIONS, tmp_path / "missions")
    mission = missions / "01_apartment.yaml"
    text = mission.read_text()
    assert "radius: 0.25 m," in text
    assert "time: 30 min" in text
    text = text.replace("radius: 0.25 m,", "radius: 0.25 m, battery_life: 90 s,")
    mission.write_text(re.sub(r"time: 30 min.*", limit, text))
    result = run(str(mission), "slam=ground_truth")
    assert result.outcome is Outcome.BUDGET
    assert f"left of the {limit.split(':')[0]} budget" in result.reason
    assert result.distance_to_home_m < 0.2
    assert result.coverage is not None
    assert result.coverage > 0.3
    assert result.mission_time_s <= 90.0
    assert result.path_length_m <= 25.0
    if limit.startswith(("time", "battery")):
        assert result.mission_time_s <= 72.0


def test_a_mission_goes_on_in_yesterdays_map(run: RunMission, tmp_path: Path) -> None:
    first = run("02_any_map.yaml", "world=missions/worlds/room.yaml", out="yesterday")
    again = run(
        "02_any_map.yaml",
        "world=missions/worlds/room.yaml",
        f"map={tmp_path}/yesterday/slam",
        out="today",
        seed=1,
    )
    assert again.outcome is Outcome.EXPLORED
    assert again.coverage is not None
    assert first.coverage is not None
    assert again.coverage >= first.coverage - 0.01
    assert again.path_length_m < 0.2 * first.path_length_m
    assert again.ate_rmse_m is not None
    assert again.ate_rmse_m < 0.02
    stamps = np.loadtxt(tmp_path / "today/trajectory.tum", ndmin=2)[:, 0]
    assert stamps.max() <= again.mission_time_s
    assert (np.diff(stamps) > 0.0).all()


def test_a_recorded_mission_maps_again_to_the_same_trajectory(
    run: RunMission, registry: Registry, tmp_path: Path
) -> None:
    stop = StopFlag()
    recorder = registry.get("sink", "mcap")
    run("00_room.yaml", seed=1, stop=stop, sinks=[recorder(recorder.Options()), StopAfter(stop, 20.0)])
    again = tmp_path / "again"
    shown = CliRunner().invoke(app, ["slam", str(tmp_path / "run" / "recording.mcap"), "--out", str(again)])
    assert shown.exit_code == 0, shown.output
    first, second = (np.loadtxt(folder / "trajectory.tum") for folder in (tmp_path / "run", again))
    assert len(first) == len(second) > 150
    np.testing.assert_allclose(second[:, 0], first[:, 0], atol=1e-5)
    assert np.hypot(*(second - first)[:, 1:3].T).max() < 0.01
