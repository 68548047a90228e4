"""3D lidar, camera, battery: what one side measures the other side hears; the balancing robot over topics."""

from __future__ import annotations

from tests.ros2 import ros  # isort: skip  # noqa: F401

import importlib.util
import json
import threading
import time
from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from explore_bt_ros2.driver import Ros2
from explore_bt_ros2.link import Link
from explore_bt_ros2.options import Ros2Options
from explore_bt_ros2.trial.robot import TrialRobot
from scipy.spatial.transform import Rotation

from explore_bt.interfaces import RobotContext
from explore_bt.types import Battery, Imu, PointCloud, RgbdFrame
from tests.ros2.processes import Process, until
from tests.ros2.worlds import paced, robot_in

MISSIONS = Path(__file__).parents[2] / "missions"
CAMERA = {"colour_topic": "camera/color/image_raw", "depth_topic": "camera/depth/image_raw"}
RNG = np.random.default_rng(5)


def mount(x: float, z: float, *angles: float) -> np.ndarray:
    T = np.eye(4)
    T[:3, :3] = Rotation.from_euler("xyz", angles).as_matrix()
    T[:3, 3] = (x, 0.0, z)
    return T


def cloud(stamp_s: float) -> PointCloud:
    """Tilted, in parts blind, swept in 0.1 s; some directions without return."""
    points = RNG.uniform(-5.0, 5.0, (400, 3)).astype(np.float32)
    points[::7], points[3] = np.nan, np.inf
    times_s = np.sort(RNG.uniform(-0.1, 0.0, 400))
    times_s[-1] = 0.0
    return PointCloud(stamp_s, points, times_s, mount(0.1, 0.5, 0.0, 0.2, 0.4), "lidar", 5.0)


def frame(stamp_s: float) -> RgbdFrame:
    image = RNG.integers(0, 255, (24, 32, 3), dtype=np.uint8)
    depth = RNG.uniform(0.3, 6.0, (24, 32)).astype(np.float32)
    depth[::5] = np.nan
    place = mount(0.05, 0.4, -0.5 * np.pi, 0.0, -0.5 * np.pi)
    return RgbdFrame(stamp_s, image, depth, 30.0, 31.0, 15.5, 11.5, place, "camera_optical")


class Talker:
    """A robot that says at 10 Hz what its sensors measure, and keeps what it said."""

    def __init__(self) -> None:
        self._link = Link("robot")
        self._robot = TrialRobot(self._link, lambda stamp_s: stamp_s)
        self._link.start()
        self._over = threading.Event()
        self.said: dict[type, list] = defaultdict(list)
        self._thread = threading.Thread(target=self._talk)
        self._thread.start()

    def _talk(self) -> None:
        while not self._over.wait(0.1):
            now_s = time.time()
            for each in (cloud(now_s), frame(now_s), Imu(now_s, (0.1, 0.2, 0.3), (0.0, 0.1, 9.8))):
                self.said[type(each)].append(each)
                self._robot.publish(each)
            self._robot.publish(Battery(now_s, 0.75))

    def close(self) -> None:
        self._over.set()
        self._thread.join()
        self._link.close()


@pytest.fixture
def talker() -> Iterator[Talker]:
    robot = Talker()
    yield robot
    robot.close()


def test_clouds_images_and_charge_are_heard_as_they_were_measured(talker):
    driver = Ros2(Ros2Options(scan_topic="", cloud_topic="points", cloud_range=5.0, **CAMERA))
    driver.setup(RobotContext())
    heard: dict[type, list] = defaultdict(list)

    def enough() -> bool:
        for each in driver.read():
            heard[type(each)].append(each)
        return all(len(heard[kind]) > 3 for kind in (PointCloud, RgbdFrame, Imu, Battery))

    try:
        until(enough, 20.0, "every sensor is heard")
        assert driver.hindrance() == ""
        for kind in (PointCloud, RgbdFrame, Imu):
            for measured in heard[kind]:
                stamp_s = driver.clock.stamp_s(measured.stamp_s)
                same = min(talker.said[kind], key=lambda each, at=stamp_s: abs(each.stamp_s - at))
                assert abs(same.stamp_s - stamp_s) < 2e-3  # order may need a tenth of a millisecond
                assert_same(measured, same)
        assert {each.charge for each in heard[Battery]} == {0.75}
    finally:
        driver.close()


def assert_same(heard, said) -> None:
    """All but the stamp."""
    if isinstance(said, Imu):
        assert heard.angular_velocity_rps == pytest.approx(said.angular_velocity_rps)
        assert heard.linear_acceleration_mps2 == pytest.approx(said.linear_acceleration_mps2)
        return
    np.testing.assert_allclose(heard.T_base_sensor, said.T_base_sensor, atol=1e-9)
    assert heard.frame == said.frame
    if isinstance(said, PointCloud):
        np.testing.assert_array_equal(heard.points, said.points)
        np.testing.assert_allclose(heard.times_s, said.times_s, atol=1e-6)
        assert heard.range_max_m == said.range_max_m
    else:
        np.testing.assert_array_equal(heard.image, said.image)
        np.testing.assert_array_equal(heard.depth_m, said.depth_m)
        assert (heard.fx, heard.fy, heard.cx, heard.cy) == (said.fx, said.fy, said.cx, said.cy)


@pytest.mark.slow
@pytest.mark.skipif(importlib.util.find_spec("mujoco") is None, reason="the extra mujoco is not installed")
def test_the_balancing_robot_explores_by_3d_lidar_and_camera_over_topics(tmp_path):
    text = (MISSIONS / "06_ros2.yaml").read_text().replace("[trees/strategies.yaml]", "[strategies.yaml]")
    lidar = 'scan_topic: "", cloud_topic: points, cloud_range: 5 m, height: 0.6 m'
    camera = ", ".join(f"{option}: {topic}" for option, topic in CAMERA.items())
    body = "command_delay: 0.225 s, jerk: 1.5"
    mine = text.replace("use: ros2,", f"use: ros2, {lidar}, {camera}, {body},")
    mine = mine.replace("{use: $params.slam}", "{use: kiss_gtsam, clear_start: 1 m}")
    mine = mine.replace("limits:\n", "limits:\n  distance: 3 m\n")
    (tmp_path / "mine.yaml").write_text(mine)
    for tree in (MISSIONS / "trees").glob("*.yaml"):
        (tmp_path / tree.name).write_text(tree.read_text())
    start, truth = ("--set", "start=[3.3 m, 3.6 m, 0 deg]"), tmp_path / "truth.json"
    room = ("--seed", "1", "--speed", f"{paced(1.0):.2f}", *start, "--out", truth)
    with robot_in(MISSIONS / "04_mujoco_flat.yaml", *room) as robot:
        run = ("run", tmp_path / "mine.yaml", *start, "--set", "sim=true", "--headless")
        with Process(*run, "--out", tmp_path / "run") as mission:
            mission.finish(deadline_s=240.0)
    result = json.loads((tmp_path / "run/result.json").read_text())
    assert result["outcome"] == "budget", mission.text
    assert json.loads(truth.read_text())["contacts"] == 0, robot.text
    assert result["slam"]["scans"] > 50
    assert result["slam"]["voxel_mb"] > 0.0  # made of clouds
    with np.load(tmp_path / "run/slam/slam.npz") as saved:
        assert len(saved["sight_descriptors"]) > 100  # of the camera's images
