"""Two robots in one simulated world, each in a namespace of its own; a mission in another process."""

from __future__ import annotations

from tests.ros2 import ros  # isort: skip  # noqa: F401

import json
from pathlib import Path

import pytest
from explore_bt_ros2.crew import Crew

from explore_bt.errors import PluginError
from explore_bt.exploration import CoverageMeter
from explore_bt.interfaces import Commons, RobotContext
from explore_bt.maps import read_map
from explore_bt.plugin import load_plugins
from explore_bt.types import Pose2
from tests.ros2.processes import Process
from tests.ros2.worlds import robot_in

MISSIONS = Path(__file__).parents[2] / "missions"
ROOM = MISSIONS / "worlds/room.yaml"
STARTS = {"ada": Pose2(1.0, 1.0, 0.0), "bob": Pose2(2.2, 2.3, 0.0)}
STACK = "slam: kiss_gtsam, planner: skeleton, controller: pursuit"


def fleet(driver: str) -> str:
    """A mission of both; ``NAME`` in the driver stands for the robot's."""
    robots = "\n".join(
        f"  {name}: {{start: [{start.x} m, {start.y} m, 0 deg], "
        f"driver: {{{driver.replace('NAME', name)}, radius: 0.25 m}}, {STACK}}}"
        for name, start in STARTS.items()
    )
    return (
        "format: explore-bt/1\nname: two\ninclude: [complete.yaml]\n"
        f"robots:\n{robots}\nteam: {{use: local}}\nallocator: {{use: auction}}\n"
        "limits: {speed: 0.5 m/s, time: 10 min}\ntree: complete\n"
    )


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    for tree in (MISSIONS / "trees").glob("*.yaml"):
        (tmp_path / tree.name).write_text(tree.read_text())
    (tmp_path / "room.yaml").write_text(ROOM.read_text())
    (tmp_path / "simulated.yaml").write_text(fleet("use: sim2d, world: room.yaml, lidar_range: 5 m"))
    over_topics = "use: ros2, namespace: NAME, tf_topic: tf, use_sim_time: true"
    (tmp_path / "fleet.yaml").write_text(fleet(over_topics))
    return tmp_path


@pytest.mark.slow
def test_two_robots_divide_a_flat_over_topics_and_make_one_map_of_it(folder):
    truth = folder / "truth.json"
    with robot_in(folder / "simulated.yaml", "--seed", "1", "--speed", "2", "--out", truth):
        words = ("run", folder / "fleet.yaml", "--headless", "--out", folder / "run")
        with Process(*words) as mission:
            code = mission.finish(deadline_s=180.0)
    assert code == 0, mission.text
    assert [each["contacts"] for each in json.loads(truth.read_text()).values()] == [0, 0]
    sim2d = load_plugins().registry.get("driver", "sim2d")
    driver = sim2d(sim2d.Options(world=ROOM, radius=0.25, lidar_range=5.0))
    driver.setup(RobotContext(start=STARTS["ada"]))
    floor = driver.truth().observable_floor()
    assert CoverageMeter(floor).measure(read_map(folder / "run" / "map.yaml")) >= 0.98
    for name in STARTS:
        assert (folder / "run" / name / "map.pgm").is_file()


def test_robots_of_one_mission_have_one_clock_and_those_of_another_do_not_meet_them():
    commons = Commons()
    ada, bob = (Crew.of(commons, use_sim_time=True, begin_s=0.0) for _ in range(2))
    assert ada.join("ada", "/ada/cmd_vel", has_start=True)
    assert not bob.join("bob", "/bob/cmd_vel", has_start=True)
    assert ada.clock is bob.clock
    assert Crew.of(Commons(), use_sim_time=True, begin_s=0.0).clock is not ada.clock


def test_two_robots_that_would_hear_the_same_commands_are_refused_with_what_to_write():
    crew = Crew.of(Commons(), use_sim_time=False, begin_s=0.0)
    crew.join("ada", "/cmd_vel", has_start=True)
    with pytest.raises(PluginError, match=r"ada and bob both hear /cmd_vel.*namespace: bob, tf_topic: tf"):
        crew.join("bob", "/cmd_vel", has_start=True)


def test_of_several_robots_each_needs_a_start():
    crew = Crew.of(Commons(), use_sim_time=False, begin_s=0.0)
    crew.join("ada", "/ada/cmd_vel", has_start=False)
    with pytest.raises(PluginError, match=r"nobody said where ada begins; .* start: \[1 m, 2 m, 90 deg\]"):
        crew.join("bob", "/bob/cmd_vel", has_start=True)
