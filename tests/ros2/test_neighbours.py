"""Somebody else's SLAM makes the map; what a mission offers to others."""

from __future__ import annotations

from tests.ros2 import ros  # isort: skip  # noqa: F401

import json
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from explore_bt_ros2.link import Link
from explore_bt_ros2.neighbour_map import Ros2Map
from explore_bt_ros2.transforms import TransformBuffer, decode
from nav_msgs.msg import OccupancyGrid as GridMessage
from nav_msgs.msg import Path as PathMessage
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import String
from std_srvs.srv import Trigger
from visualization_msgs.msg import MarkerArray

from explore_bt.errors import PluginError
from explore_bt.exploration import CoverageMeter
from explore_bt.interfaces import RobotContext
from explore_bt.maps import read_map
from explore_bt.plugin import load_plugins
from explore_bt.types import Pose2
from tests.ros2.processes import Process, until
from tests.ros2.worlds import robot_in

MISSIONS = Path(__file__).parents[2] / "missions"
START = Pose2(1.0, 1.0, 0.0)
ROOM = MISSIONS / "worlds/room.yaml"
PLACE = ["--set", f"world={ROOM}", "--set", f"start=[{START.x} m, {START.y} m, 0 deg]"]
SIM = ["--seed", "1", "--speed", "3", *PLACE]
SIMULATED = ["--set", "sim=true", "--headless"]
KEPT = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)


@contextmanager
def foreign_slam() -> Iterator[None]:
    script = Path(__file__).with_name("foreign_slam.py")
    process = subprocess.Popen([sys.executable, script], stdout=subprocess.PIPE, text=True)
    try:
        assert process.stdout is not None
        assert "runs" in process.stdout.readline()
        yield
    finally:
        process.terminate()
        process.communicate(timeout=10.0)


def test_ros2_map_without_the_ros2_driver_says_what_to_write():
    with pytest.raises(PluginError, match=r"driver: \{use: ros2\}"):
        Ros2Map(Ros2Map.Options()).setup(RobotContext())


def test_a_foreign_slam_in_a_third_process_makes_the_map_of_the_same_mission(tmp_path):
    truth = tmp_path / "truth.json"
    with robot_in(MISSIONS / "02_any_map.yaml", *SIM, "--out", truth), foreign_slam():
        words = ["run", MISSIONS / "06_ros2.yaml", *SIMULATED, "--set", "slam=ros2_map"]
        with Process(*words, "--out", tmp_path / "run") as mission:
            code = mission.finish(deadline_s=120.0)
    assert code == 0, mission.text
    assert json.loads(truth.read_text())["contacts"] == 0
    sim2d = load_plugins().registry.get("driver", "sim2d")
    driver = sim2d(sim2d.Options(world=ROOM, radius=0.25, lidar_range=5.0))
    driver.setup(RobotContext(start=START))
    grid = read_map(tmp_path / "run" / "map.yaml")
    x, y = grid.origin_xy
    in_world = replace(grid, origin_xy=(x + START.x, y + START.y))  # its map begins where the robot stood
    assert CoverageMeter(driver.truth().observable_floor()).measure(in_world) >= 0.98


class Onlooker:
    """Somebody else on the network."""

    def __init__(self) -> None:
        self._link = Link("onlooker")
        self.buffer = TransformBuffer()
        self.heard: dict[str, Any] = {}
        for topic, kind in (
            ("map", GridMessage),
            ("explore_bt/path", PathMessage),
            ("explore_bt/marks", MarkerArray),
            ("explore_bt/tree", String),
            ("explore_bt/result", String),
        ):
            self._link.subscribe(
                kind, topic, lambda each, topic=topic: self.heard.update({topic: each}), KEPT
            )
        self._feedback: dict[str, Any] = {}
        self._link.subscribe(String, "explore_bt/feedback", self._on_feedback, QoSProfile(depth=10))
        tf = self._link.tf_type
        learn = self.buffer.learn
        self._link.subscribe(tf, "/tf", lambda data: learn(decode(data)), QoSProfile(depth=100), raw=True)
        names = ("explore", "pause", "go_on", "save_map", "stop")
        self._clients = {name: self._link.node.create_client(Trigger, f"explore_bt/{name}") for name in names}
        self._link.start()

    def call(self, name: str, *, works: bool = True) -> str:
        client = self._clients[name]
        assert client.wait_for_service(10.0), name
        answer = client.call_async(Trigger.Request())
        until(answer.done, 10.0, f"{name} answers")
        assert answer.result().success is works
        return str(answer.result().message)

    def wait_for_feedback(self, state: str, what: str = "time_s") -> dict[str, Any]:
        """One that says of the mission that it is in this state, and something of ``what``."""

        def is_said() -> bool:
            return self._feedback.get("state") == state and bool(self._feedback[what])

        until(is_said, 20.0, f"the feedback says {state} and {what}")
        return self._feedback

    def close(self) -> None:
        self._link.close()

    def _on_feedback(self, message: Any) -> None:
        self._feedback = json.loads(message.data)


def test_others_see_the_map_the_way_and_the_tree_and_may_begin_pause_save_and_stop_it(tmp_path):
    text = (MISSIONS / "06_ros2.yaml").read_text().replace("use: ros2,", "use: ros2, start_when_asked: true,")
    (tmp_path / "mine.yaml").write_text(text.replace("[trees/strategies.yaml]", "[strategies.yaml]"))
    for tree in (MISSIONS / "trees").glob("*.yaml"):
        (tmp_path / tree.name).write_text(tree.read_text())
    onlooker, run = Onlooker(), tmp_path / "run"
    try:
        with (
            robot_in(MISSIONS / "02_any_map.yaml", *SIM),
            Process(
                "run", tmp_path / "mine.yaml", "--set", "sim=true", "--headless", "--out", run
            ) as mission,
        ):
            onlooker.call("save_map")
            assert "explore_bt/path" not in onlooker.heard or not onlooker.heard["explore_bt/path"].poses
            assert onlooker.wait_for_feedback("waiting")["distance_m"] == 0.0
            assert "~/stop" in onlooker.call("explore")
            assert "it explores already" in onlooker.call("explore", works=False)
            until(
                lambda: "explore_bt/path" in onlooker.heard and onlooker.heard["explore_bt/path"].poses,
                30.0,
                "a path is shown",
            )
            until(lambda: len(onlooker.heard["explore_bt/marks"].markers) > 1, 5.0, "marks are shown")
            assert onlooker.buffer.find("map", "base_link") is not None
            assert (run / "map.pgm").is_file()
            going = onlooker.wait_for_feedback("exploring", "doing")
            assert going["doing"].startswith("complete")
            assert going["free_m2"] > 1.0
            assert going["left"]["time"] > 1000.0
            onlooker.call("pause")
            assert "paused" in onlooker.wait_for_feedback("paused", "held")["held"]
            until(lambda: _rests(onlooker), 20.0, "it stands")
            onlooker.call("go_on")
            onlooker.call("stop")
            code = mission.finish(60.0)
    finally:
        onlooker.close()
    assert code == 130, mission.text
    assert "stopped by a request to robot robot" in mission.text
    cells = np.asarray(onlooker.heard["map"].data, dtype=np.int8)
    assert set(np.unique(cells)) <= {-1, 0, 100}
    assert (cells == 0).sum() > 400
    assert {"path", "type", "status", "message"} == set(json.loads(onlooker.heard["explore_bt/tree"].data)[0])
    assert json.loads(onlooker.heard["explore_bt/result"].data)["outcome"] == "stopped"


def _rests(onlooker: Onlooker) -> bool:
    """Whether the robot does not move for a quarter of a second of its own time."""
    newest_s = onlooker.buffer.newest_s("odom", "base_link")
    if newest_s is None:
        return False
    now = onlooker.buffer.find("odom", "base_link", newest_s)
    before = onlooker.buffer.find("odom", "base_link", newest_s - 0.25)
    return now is not None and before is not None and bool(np.abs(now - before).max() < 1e-3)
