"""A plugin that breaks down at work: the robot stops safely, the reason is told, nothing crashes."""

import shutil
from collections.abc import Callable, Sequence
from pathlib import Path

import pytest

from explore_bt.interfaces import Controller, Driver, Planner, Slam, TickSnapshot
from explore_bt.mission import load_mission
from explore_bt.plugin import Registry, load_plugins
from explore_bt.runtime import StopFlag, run_mission
from explore_bt.tree import Leaf
from explore_bt.types import Health, Measurement, Outcome, Result, Scan2D

from .conftest import MISSIONS, RunMission, Watcher


def after(count: int, method: Callable[..., object]) -> Callable[..., object]:
    """``method``, which raises from its ``count``-th call on."""
    calls = 0

    def failing(self: object, *arguments: object, **keywords: object) -> object:
        nonlocal calls
        calls += 1
        if calls > count:
            raise RuntimeError("cable pulled")
        return method(self, *arguments, **keywords)

    return failing


def run_with(broken: type, tmp_path: Path, use: str) -> tuple[Result, Watcher]:
    registry = load_plugins().registry
    registry.add(broken, "the test")
    text = (MISSIONS / "00_room.yaml").read_text().replace("worlds/", f"{MISSIONS}/worlds/")
    text = text.replace("slam: {use: $params.slam}", "slam: {use: ground_truth}").replace(use, broken.name)
    shutil.copytree(MISSIONS / "trees", tmp_path / "trees")
    (tmp_path / "mission.yaml").write_text(text)
    mission = load_mission(tmp_path / "mission.yaml", registry, ["limits.time=40 s"])
    watcher = Watcher()
    result = run_mission(
        mission, registry=registry, out=tmp_path / "run", seed=0, sinks=[watcher], stop=StopFlag()
    )
    return result, watcher


def built_in(kind: str, name: str) -> type:
    return load_plugins().registry.get(kind, name)


def test_a_slam_that_raises_is_lost_and_the_robot_brakes(tmp_path: Path) -> None:
    base: type[Slam] = built_in("slam", "ground_truth")
    broken = type("Broken", (base,), {"name": "broken", "update": after(900, base.update)})
    result, watcher = run_with(broken, tmp_path, "ground_truth")
    assert result.contacts == 0
    assert any(event.level == "error" and "cable pulled" in event.message for event in watcher.events)
    last = watcher.ticks[-1].robots[0]
    assert last.estimate.health is Health.LOST
    assert "SLAM is lost: slam broken failed" in last.gate_reason
    assert abs(last.motion.twist.linear_mps) < 1e-3


def test_a_controller_that_raises_is_braked_for_and_logged_once(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    base: type[Controller] = built_in("controller", "pursuit")
    broken = type("Broken", (base,), {"name": "broken", "step": after(150, base.step)})
    result, watcher = run_with(broken, tmp_path, "pursuit")
    assert result.contacts == 0
    last = watcher.ticks[-1].robots[0]
    assert "controller broken failed" in last.gate_reason
    assert abs(last.motion.twist.linear_mps) < 1e-3
    logged = [record for record in caplog.records if record.levelname == "ERROR"]
    assert len(logged) == 1
    assert "controller broken failed" in logged[0].getMessage()
    assert logged[0].exc_info is not None
    assert "cable pulled" in str(logged[0].exc_info[1])


def test_a_planner_that_raises_fails_the_drive_with_its_reason(tmp_path: Path) -> None:
    base: type[Planner] = built_in("planner", "skeleton")
    broken = type("Broken", (base,), {"name": "broken", "plan": after(2, base.plan)})
    result, watcher = run_with(broken, tmp_path, "skeleton")
    assert result.contacts == 0
    assert any(event.source == "planner broken" for event in watcher.events)


class Silent:
    """Mixed into a driver: its lidar falls silent after five seconds, the rest goes on."""

    name = "broken"

    def read(self) -> Sequence[Measurement]:
        measurements = super().read()  # type: ignore[misc]  # the driver it is mixed into
        return [each for each in measurements if not isinstance(each, Scan2D) or each.stamp_s < 5.0]


def test_a_lidar_that_falls_silent_stops_the_robot_within_its_staleness(tmp_path: Path) -> None:
    base: type[Driver] = built_in("driver", "sim2d")
    result, watcher = run_with(type("Broken", (Silent, base), {}), tmp_path, "sim2d")
    assert result.contacts == 0
    moving = [tick.stamp_s for tick in watcher.ticks if abs(tick.robots[0].motion.twist.linear_mps) > 0.01]
    assert max(moving) < 8.0
    assert any("the newest scan is 0." in tick.robots[0].gate_reason for tick in watcher.ticks)


def test_a_leaf_that_raises_ends_the_mission_at_rest_with_its_reason(tmp_path: Path) -> None:
    base: type[Leaf] = built_in("behaviour", "record_waypoint")
    broken = type("Broken", (base,), {"type_key": "broken", "update": after(1, base.update)})
    broken.name = "broken"
    registry = load_plugins().registry
    registry.add(broken, "the test")
    trees = (MISSIONS / "trees/complete.yaml").read_text().replace("record_waypoint", "broken")
    shutil.copytree(MISSIONS / "trees", tmp_path / "trees")
    (tmp_path / "trees/complete.yaml").write_text(trees)
    text = (MISSIONS / "00_room.yaml").read_text().replace("worlds/", f"{MISSIONS}/worlds/")
    (tmp_path / "mission.yaml").write_text(text)
    mission = load_mission(tmp_path / "mission.yaml", registry, ["slam=ground_truth"])
    watcher = Watcher()
    result = run_mission(
        mission, registry=registry, out=tmp_path / "run", seed=0, sinks=[watcher], stop=StopFlag()
    )
    assert result.reason == "a leaf failed: RuntimeError('cable pulled')"
    assert abs(watcher.ticks[-1].robots[0].motion.twist.linear_mps) < 1e-3
    assert (tmp_path / "run/result.json").exists()


def test_a_driver_that_never_scans_is_named(tmp_path: Path) -> None:
    base: type[Driver] = built_in("driver", "sim2d")
    deaf = type("Broken", (base,), {"name": "broken", "read": lambda self: ()})
    result, _ = run_with(deaf, tmp_path, "sim2d")
    assert result.reason == "robot robot: driver broken gave no scan in 5 s; check the lidar"


def test_a_lidar_of_which_every_beam_is_invalid_is_named(run: RunMission, tmp_path: Path) -> None:
    text = (MISSIONS / "00_room.yaml").read_text()
    text = text.replace("worlds/room.yaml", f"{MISSIONS}/worlds/room.yaml, dropout: 1.0")
    shutil.copytree(MISSIONS / "trees", tmp_path / "trees")
    (tmp_path / "mission.yaml").write_text(text)
    result = run(tmp_path / "mission.yaml", "slam=ground_truth")
    assert (result.outcome, result.reason) == (
        Outcome.FAILED,
        "robot robot: driver sim2d gave only scans without a valid beam in 5 s; check the lidar",
    )


def test_a_failed_way_home_is_named_beside_the_reason_to_go_there(tmp_path: Path) -> None:
    base: type[Planner] = built_in("planner", "skeleton")
    broken = type("Broken", (base,), {"name": "broken", "plan": after(1, base.plan)})
    result, _ = run_with(broken, tmp_path, "skeleton")
    assert result.outcome is Outcome.FAILED
    explored, home = result.reason.split("; ")
    assert explored.startswith("no reachable place shows")
    assert home == "drive_to: no path: planner broken: RuntimeError('cable pulled')"


def test_a_robot_that_is_done_waits_for_the_others(tmp_path: Path, registry: Registry) -> None:
    robot = (
        "{driver: {use: sim2d, world: %s}, slam: ground_truth, planner: skeleton, controller: pursuit, %s}"
    )
    world = f"{MISSIONS}/worlds/room.yaml"
    (tmp_path / "mission.yaml").write_text(
        "format: explore-bt/1\nrobots:\n"
        f"  quick: {robot % (world, 'tree: {wait: {duration: 1 s}}')}\n"
        f"  slow: {robot % (world, 'tree: {wait: {duration: 2.5 s}}')}\n"
    )
    mission = load_mission(tmp_path / "mission.yaml", registry)
    result = run_mission(mission, registry=registry, out=tmp_path / "run", seed=0, sinks=[], stop=StopFlag())
    assert result.outcome is Outcome.EXPLORED
    assert 2.5 < result.mission_time_s < 3.5


def test_a_sink_that_raises_does_not_end_the_mission(tmp_path: Path, registry: Registry) -> None:
    class Raising(Watcher):
        name = "raising"

        def on_tick(self, tick: TickSnapshot) -> None:
            raise RuntimeError("disk full")

    mission = load_mission(MISSIONS / "00_room.yaml", registry, ["slam=ground_truth", "limits.time=3 s"])
    result = run_mission(
        mission, registry=registry, out=tmp_path / "run", seed=0, sinks=[Raising()], stop=StopFlag()
    )
    assert result.reason == "the time budget of 3 s is spent"


@pytest.mark.parametrize("signal_name", ["SIGINT", "SIGTERM"])
def test_a_signal_stops_safely_saves_and_exits_with_130(tmp_path: Path, signal_name: str) -> None:
    import signal
    import subprocess
    import sys
    import time

    out = tmp_path / "run"
    command = [
        Path(sys.executable).with_name("explore-bt"),
        "run",
        MISSIONS / "01_apartment.yaml",
        "--headless",
    ]
    process = subprocess.Popen([*map(str, command), "--set", "slam=ground_truth", "--out", str(out)])
    while not (out / "recording.mcap").exists():
        assert process.poll() is None
        time.sleep(0.05)
    time.sleep(1.0)
    process.send_signal(getattr(signal, signal_name))
    assert process.wait(timeout=60) == 130
    assert '"outcome": "stopped"' in (out / "result.json").read_text()
    assert (out / "report.html").stat().st_size > 0
