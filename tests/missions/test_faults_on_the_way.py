"""Senses that fail and a world that changes on the way: no contact, the reason in words, and on it goes."""

import math
import shutil
from collections import deque
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import ClassVar

import numpy as np
import pytest

from explore_bt.interfaces import (
    API_VERSION,
    Driver,
    PluginOptions,
    RobotContext,
    RobotSnapshot,
    Slam,
    TickSnapshot,
)
from explore_bt.mission import load_mission
from explore_bt.plugin import load_plugins
from explore_bt.runtime import StopFlag, run_mission
from explore_bt.types import (
    Estimate,
    GridWindow,
    Measurement,
    OccupancyGrid,
    Outcome,
    Result,
    Scan2D,
    Trajectory,
)

from .conftest import MISSIONS, Watcher

GOAL = (8.5, 1.0)
BLIND_S = (6.0, 10.0)
"""On the way through the hall: the drive begins after 2 s and takes 17 s."""
STANDS_AFTER_S = 2.5
"""A second until even the slowest fault is noticed, then the brake from 0.5 m/s."""
FAR_DOOR = "  - {name: far, at: [6, 3.1]}\n"


def house(folder: Path, near: str = "", doors: str = FAR_DOOR, furniture: str = "") -> Path:
    """A hall and a study with a door straight on to the goal, and another one beside it."""
    path = folder / "world.yaml"
    path.write_text(
        "format: explore-bt-world/1\nname: house\nstart: [1 m, 2 m, 0]\n"
        "rooms:\n  - {name: hall, box: [0, 0, 6, 4]}\n  - {name: study, box: [6, 0, 10, 4]}\n"
        f"doors:\n  - {{name: near, at: [6, 0.9]{near}}}\n{doors}"
        f"furniture:\n  - {{name: bench, box: [2.5, 0.05, 3.5, 0.5]}}\n{furniture}"
    )
    return path


@pytest.fixture(scope="module")
def map_of(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], Path]:
    """The map of the house as it was yesterday, by the name of the SLAM that made it."""
    made: dict[str, Path] = {}

    def map_of(slam: str) -> Path:
        if slam not in made:
            folder = tmp_path_factory.mktemp(slam)
            registry = load_plugins().registry
            settings = [f"world={house(folder)}", f"slam={slam}"]
            mission = load_mission(MISSIONS / "02_any_map.yaml", registry, settings)
            run_mission(mission, registry=registry, out=folder, seed=0, sinks=[], stop=StopFlag())
            made[slam] = folder / "slam"
        return made[slam]

    return map_of


def errand(
    folder: Path,
    world: Path,
    known: Path,
    *,
    driver: type[Driver] | None = None,
    slam: type[Slam] | None = None,
) -> tuple[Result, Watcher]:
    """The shipped errand to ``GOAL`` in a known map, with these plugins for sim2d and ground truth."""
    registry = load_plugins().registry
    text = (MISSIONS / "03_errand.yaml").read_text().replace("worlds/", f"{MISSIONS}/worlds/")
    for plugin in filter(None, (driver, slam)):
        registry.add(plugin, "the test")
    if driver is not None:
        text = text.replace("use: sim2d", f"use: {driver.name}")
    shutil.copytree(MISSIONS / "trees", folder / "trees")
    (folder / "errand.yaml").write_text(text)
    x, y = GOAL
    settings = [f"world={world}", f"map={known}", f"x={x}", f"y={y}"]
    settings.append(f"slam={slam.name if slam else 'ground_truth'}")
    mission = load_mission(folder / "errand.yaml", registry, settings)
    watcher = Watcher()
    result = run_mission(
        mission, registry=registry, out=folder / "run", seed=0, sinks=[watcher], stop=StopFlag()
    )
    return result, watcher


def robots(watcher: Watcher, begin_s: float = 0.0, end_s: float = math.inf) -> list[RobotSnapshot]:
    return [tick.robots[0] for tick in watcher.ticks if begin_s <= tick.stamp_s < end_s]


def speed_mps(robot: RobotSnapshot) -> float:
    return abs(robot.motion.twist.linear_mps)


def failures(watcher: Watcher) -> list[str]:
    """Every code that a drive has failed with, in the order in which they came."""
    codes = (str(robot.blackboard.get("failure", "")) for robot in robots(watcher))
    return list(dict.fromkeys(code for code in codes if code))


def words(watcher: Watcher, source: str) -> str:
    return "\n".join(event.message for event in watcher.events if event.source == source)


def assert_arrived(result: Result, watcher: Watcher) -> None:
    assert (result.outcome, result.contacts) == (Outcome.EXPLORED, 0), result.reason
    true_pose = robots(watcher)[-1].true_pose
    assert true_pose is not None
    assert math.dist(true_pose.xy, GOAL) < 0.1


def assert_stood_while_blind(watcher: Watcher) -> None:
    """Under way when the fault began, at rest until it ended, and under way again."""
    begin_s, end_s = BLIND_S
    assert speed_mps(robots(watcher, end_s=begin_s)[-1]) > 0.4
    assert all(speed_mps(robot) < 1e-3 for robot in robots(watcher, begin_s + STANDS_AFTER_S, end_s))
    assert max(speed_mps(robot) for robot in robots(watcher, end_s)) > 0.4


def faulty_lidar(damage: Callable[[Scan2D], Sequence[Scan2D]]) -> type[Driver]:
    """sim2d, with its scans damaged during ``BLIND_S``."""
    base: type[Driver] = load_plugins().registry.get("driver", "sim2d")

    def read(self: Driver) -> Sequence[Measurement]:
        measured: list[Measurement] = []
        for each in base.read(self):
            is_hit = isinstance(each, Scan2D) and BLIND_S[0] <= each.stamp_s < BLIND_S[1]
            measured += damage(each) if is_hit else [each]  # type: ignore[arg-type]  # a scan if it is hit
        return measured

    return type("Faulty", (base,), {"name": "faulty", "read": read})


def no_scan(_: Scan2D) -> Sequence[Scan2D]:
    return ()


def invalid_scan(scan: Scan2D) -> Sequence[Scan2D]:
    return (replace(scan, ranges_m=np.full_like(scan.ranges_m, np.nan)),)


class LateSlam(Slam):
    """Another SLAM, of which nobody hears anything but what it said ``late_s`` ago."""

    name = "late"
    api_version = API_VERSION
    late_s = 0.3
    inner: ClassVar[type[Slam]]

    def __init__(self, options: PluginOptions) -> None:
        super().__init__(options)
        self._slam = self.inner(options)
        self._said: deque[tuple[float, Estimate, OccupancyGrid]] = deque()

    def setup(self, context: RobotContext) -> None:
        self._slam.setup(context)
        self._listen(0.0)

    def load(self, folder: Path) -> None:
        self._slam.load(folder)
        self._said.clear()
        self._listen(0.0)

    def update(self, measurement: Measurement) -> None:
        self._slam.update(measurement)
        if isinstance(measurement, Scan2D):
            self._listen(measurement.stamp_s)
        while len(self._said) > 1 and self._is_told(self._said[1][0], measurement.stamp_s):
            self._said.popleft()

    def _listen(self, stamp_s: float) -> None:
        self._said.append((stamp_s, self._slam.estimate(), self._slam.grid()))

    def _is_told(self, said_s: float, now_s: float) -> bool:
        return said_s <= now_s - self.late_s

    def estimate(self) -> Estimate:
        return self._said[0][1]

    def grid(self) -> OccupancyGrid:
        return self._said[0][2]

    def changed_since(self, revision: int) -> GridWindow | None:
        return None

    def forget_near(self, position: tuple[float, float], radius_m: float) -> bool:
        return self._slam.forget_near(position, radius_m)

    def trajectory(self) -> Trajectory:
        return self._slam.trajectory()

    def figures(self) -> Mapping[str, float]:
        return self._slam.figures()

    def save(self, folder: Path) -> None:
        self._slam.save(folder)


class StuckSlam(LateSlam):
    """One that hands out nothing new during ``BLIND_S``, and calls that healthy."""

    def _is_told(self, said_s: float, now_s: float) -> bool:
        return not BLIND_S[0] <= now_s < BLIND_S[1]


def slowed(kind: type[LateSlam], name: str) -> type[Slam]:
    """A ``LateSlam`` about the SLAM of this name, as a plugin."""
    base: type[Slam] = load_plugins().registry.get("slam", name)
    return type("Slowed", (kind,), {"inner": base, "Options": base.Options})


def lags_s(ticks: Sequence[TickSnapshot]) -> list[float]:
    return [tick.stamp_s - tick.robots[0].estimate.stamp_s for tick in ticks]


@pytest.mark.parametrize("slam", ["ground_truth", "kiss_gtsam"])
def test_an_estimate_that_comes_late_is_driven_by_all_the_same(
    tmp_path: Path, map_of: Callable[[str], Path], slam: str
) -> None:
    result, watcher = errand(tmp_path, house(tmp_path), map_of(slam), slam=slowed(LateSlam, slam))
    assert_arrived(result, watcher)
    assert min(lags_s(watcher.ticks[10:])) >= 0.3 - 1e-6
    assert "obstacle" not in words(watcher, "safety gate")
    assert failures(watcher) == []
    assert max(speed_mps(robot) for robot in robots(watcher)) > 0.45


def test_an_estimate_that_stands_still_is_not_driven_by(
    tmp_path: Path, map_of: Callable[[str], Path]
) -> None:
    slam = slowed(StuckSlam, "ground_truth")
    result, watcher = errand(tmp_path, house(tmp_path), map_of("ground_truth"), slam=slam)
    assert_stood_while_blind(watcher)
    assert "the newest estimate is 1." in words(watcher, "safety gate")
    assert_arrived(result, watcher)


@pytest.mark.parametrize(
    ("damage", "by_gate", "by_slam"),
    [
        (no_scan, "the newest scan is 0.", "degraded → lost: no scan for 1.0 s"),
        (
            invalid_scan,
            "no beam of the newest scan is valid",
            "degraded → lost: a scan in which every beam is invalid",
        ),
    ],
)
def test_a_robot_stands_until_its_scans_come_back(
    tmp_path: Path,
    map_of: Callable[[str], Path],
    damage: Callable[[Scan2D], Sequence[Scan2D]],
    by_gate: str,
    by_slam: str,
) -> None:
    driver = faulty_lidar(damage)
    result, watcher = errand(tmp_path, house(tmp_path), map_of("ground_truth"), driver=driver)
    assert_stood_while_blind(watcher)
    assert by_gate in words(watcher, "safety gate")
    assert by_slam in words(watcher, "slam")
    assert all(robot.gate_reason for robot in robots(watcher, BLIND_S[0] + 1.0, BLIND_S[1]))
    assert_arrived(result, watcher)


@pytest.mark.parametrize(
    ("shape", "code"),
    [
        ("circle: [9.4, 3.4, 0.12]", "goal_blocked"),
        ("box: [9, 3, 9.8, 3.8]", "no_path"),  # nobody has seen that the middle of it is not free
    ],
)
def test_a_goal_that_something_is_put_onto_ends_the_errand_with_its_reason(
    tmp_path: Path, map_of: Callable[[str], Path], shape: str, code: str
) -> None:
    thing = f"  - {{name: thing, {shape}, moved: [{{at: 8 s, to: [8.5, 1.0]}}]}}\n"
    result, watcher = errand(tmp_path, house(tmp_path, furniture=thing), map_of("ground_truth"))
    assert (result.outcome, result.contacts) == (Outcome.FAILED, 0)
    assert code in failures(watcher)
    assert "drive_to: no path: " in result.reason
    assert speed_mps(robots(watcher)[-1]) < 1e-3


def test_a_goal_that_is_taken_for_a_while_is_reached_once_it_is_free(
    tmp_path: Path, map_of: Callable[[str], Path]
) -> None:
    away = "{at: 8 s, to: [8.5, 1.0]}, {at: 35 s, to: [9.4, 3.4]}"
    thing = f"  - {{name: crate, box: [9, 3, 9.8, 3.8], moved: [{away}]}}\n"
    result, watcher = errand(tmp_path, house(tmp_path, furniture=thing), map_of("ground_truth"))
    assert result.mission_time_s > 35.0
    assert_arrived(result, watcher)


def test_a_path_that_a_door_cuts_leads_through_the_other_one(
    tmp_path: Path, map_of: Callable[[str], Path]
) -> None:
    world = house(tmp_path, near=", shut: [[8 s, 1000 s]]")
    result, watcher = errand(tmp_path, world, map_of("ground_truth"))
    assert_arrived(result, watcher)
    crossing = [robot.true_pose for robot in robots(watcher) if robot.true_pose and robot.true_pose.x > 5.9]
    assert crossing[0].y > 2.5


def test_the_only_door_is_waited_for(tmp_path: Path, map_of: Callable[[str], Path]) -> None:
    world = house(tmp_path, near=", shut: [[8 s, 20 s]]", doors="")
    result, watcher = errand(tmp_path, world, map_of("ground_truth"))
    assert "no_path" in failures(watcher)
    assert_arrived(result, watcher)


def test_the_only_door_that_stays_shut_is_named_as_no_path(
    tmp_path: Path, map_of: Callable[[str], Path]
) -> None:
    world = house(tmp_path, near=", shut: [[8 s, 1000 s]]", doors="")
    result, watcher = errand(tmp_path, world, map_of("ground_truth"))
    assert (result.outcome, result.contacts) == (Outcome.FAILED, 0)
    assert "no_path" in failures(watcher)
    assert "drive_to: no path: no passage from" in result.reason
