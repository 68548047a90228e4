"""Fleets whose starts are unknown or wrong: merged right, or not merged, and said so."""

import math
import shutil
from pathlib import Path

import numpy as np
import pytest
from explore_bt_drivers.world import load_world
from fleet import map_error_m

from explore_bt.interfaces import TickSnapshot
from explore_bt.maps import read_map
from explore_bt.mission import load_mission
from explore_bt.plugin import Registry
from explore_bt.runtime import StopFlag, run_mission
from explore_bt.types import Result

from .conftest import MISSIONS, Watcher

HEAD = "format: explore-bt/1\nname: starts\ninclude: [trees/complete.yaml]\n"
STANDS = ((3.3, 3.6, 0), (2.28, 4.23, 0))


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    shutil.copytree(MISSIONS / "trees", tmp_path / "trees")
    shutil.copytree(MISSIONS / "worlds", tmp_path / "worlds")
    shutil.copy(tmp_path / "worlds" / "apartment.yaml", tmp_path / "worlds" / "upstairs.yaml")
    return tmp_path


class Enough(Watcher):
    """Stops the run when two robots have merged their maps, and some way after it."""

    def __init__(self, stop: StopFlag) -> None:
        super().__init__()
        self.stop, self.merged_s = stop, math.inf

    def on_tick(self, tick: TickSnapshot) -> None:
        super().on_tick(tick)
        if self.merged_s == math.inf and len([each for each in told(self) if "is merged" in each]) >= 2:
            self.merged_s = tick.stamp_s
        if tick.stamp_s > self.merged_s + 5.0:
            self.stop.raise_flag("both know")


def robot(name: str, start: str, stand: tuple[float, float, float], slam: str, world: str) -> str:
    x, y, degrees = stand
    driver = f"{{use: sim2d, world: worlds/{world}.yaml, stand: [{x} m, {y} m, {degrees} deg]}}"
    return (
        f"  {name}:\n    start: {start}\n    driver: {driver}\n    slam: {slam}\n"
        "    planner: skeleton\n    controller: pursuit\n"
    )


def drive(
    folder: Path,
    registry: Registry,
    starts: tuple[str, str],
    time_s: float,
    *,
    slam: str = "kiss_gtsam",
    worlds: tuple[str, str] = ("apartment", "apartment"),
    stands: tuple[tuple[float, float, float], tuple[float, float, float]] = STANDS,
) -> tuple[Result, Watcher]:
    robots = "".join(
        robot(*each, slam, world) for *each, world in zip(("ada", "bob"), starts, stands, worlds, strict=True)
    )
    file = folder / "starts.yaml"
    file.write_text(f"{HEAD}robots:\n{robots}limits: {{time: {time_s} s}}\ntree: complete\n")
    stop = StopFlag()
    watcher = Enough(stop)
    mission = load_mission(file, registry)
    result = run_mission(mission, registry=registry, out=folder / "run", seed=0, sinks=[watcher], stop=stop)
    return result, watcher


def told(watcher: Watcher) -> list[str]:
    return [event.message for event in watcher.events if event.source == "team"]


def is_adas_map_alone(folder: Path) -> bool:
    whole, own = read_map(folder / "run" / "map.yaml"), read_map(folder / "run" / "ada" / "map.yaml")
    return bool(np.count_nonzero(whole.free) == np.count_nonzero(own.free))


def test_a_robot_that_nobody_told_where_it_begins_is_found_by_what_it_sees(
    folder: Path, registry: Registry
) -> None:
    result, watcher = drive(folder, registry, ("[3.3 m, 3.6 m, 0 deg]", "unknown"), 300.0)
    assert result.contacts == 0
    assert result.not_merged == ()
    merged = [message for message in told(watcher) if "is merged" in message]
    assert sorted(merged) == [
        f"robot {name} is merged: closures have told where it began" for name in ("ada", "bob")
    ]
    assert not is_adas_map_alone(folder)
    grid = read_map(folder / "run" / "map.yaml")
    assert map_error_m(load_world(folder / "worlds" / "apartment.yaml"), grid) < 0.05
    last = watcher.ticks[-1].robots[1]
    assert last.true_pose is not None
    assert last.estimate.T_map_base.distance_to(last.true_pose) < 0.1, "its own map begins where it stood"


def test_on_two_floors_that_look_alike_nothing_is_merged(folder: Path, registry: Registry) -> None:
    starts = ("[3.3 m, 3.6 m, 0 deg]", "[2.28 m, 4.23 m, 0 deg]")
    result, _ = drive(folder, registry, starts, 6.0, worlds=("apartment", "upstairs"))
    (sentence,) = result.not_merged
    assert sentence.startswith("robot bob: it says that it stands")
    assert is_adas_map_alone(folder)


def test_a_start_that_is_wrong_is_noticed_also_where_slam_closes_no_loops(
    folder: Path, registry: Registry
) -> None:
    wrong = (STANDS[1][0] + 1.6, STANDS[1][1] + 1.2, 60)
    assert math.hypot(1.6, 1.2) == pytest.approx(2.0)
    start = f"[{wrong[0]} m, {wrong[1]} m, {wrong[2]} deg]"
    result, _ = drive(folder, registry, ("[3.3 m, 3.6 m, 0 deg]", start), 6.0, slam="ground_truth")
    assert result.not_merged
    assert is_adas_map_alone(folder)
