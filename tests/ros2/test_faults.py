"""A mission over topics that go wrong while the robot drives: it stops, says why, and goes on."""

from __future__ import annotations

from tests.ros2 import ros  # isort: skip  # noqa: F401

import json
import math
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from pathlib import Path

import pytest
from explore_bt_ros2.driver import Ros2
from explore_bt_ros2.options import Ros2Options
from mcap.reader import make_reader

from explore_bt.interfaces import RobotContext
from tests.ros2 import relay as spoilt
from tests.ros2.processes import Process, stand_in_process, until
from tests.ros2.relay import Relay
from tests.ros2.worlds import HALL, paced, robot_in

MISSIONS = Path(__file__).parents[2] / "missions"
STOP_S = 0.3
SLACK_S = 0.15
"""Of a busy machine, where real time is measured."""
MOVING_MPS = 0.25
CRUISE_MPS = 0.3
BODY = "radius: 0.25 m, acceleration: 0.8, jerk: 40"
"""With so much jerk the first command of a brake is slower than the one before, also while speeding up."""
START = "[3.3 m, 3.6 m, 0 deg]"
STACK = "slam: kiss_gtsam, planner: skeleton, controller: pursuit"
MISSION = f"""\
format: explore-bt/1
name: faults
include: [complete.yaml]
robots: {{robot: {{start: {START}, driver: {{DRIVER, {BODY}}}, {STACK}}}}}
limits: {{speed: {CRUISE_MPS} m/s, time: 10 min}}
tree: complete
"""


@pytest.fixture
def relay(request: pytest.FixtureRequest) -> Iterator[Relay]:
    between = Relay(passes_scans=getattr(request, "param", True))
    yield between
    between.close()


def reasons(recording: Path) -> set[str]:
    """All that the safety gate ever said."""
    with recording.open("rb") as file:
        found = make_reader(file).iter_messages(topics=["/robot/gate"])
        return {json.loads(message.data)["reason"] for _, _, message in found}


@contextmanager
def mission_of(folder: Path, options: str) -> Iterator[tuple[Process, Process]]:
    """A robot behind the relay and a mission before it, on a clock that a busy machine keeps up with."""
    for tree in (MISSIONS / "trees").glob("*.yaml"):
        (folder / tree.name).write_text(tree.read_text())
    world = f"world: {MISSIONS / 'worlds/apartment.yaml'}, lidar_range: 5 m"
    (folder / "robot.yaml").write_text(MISSION.replace("DRIVER", f"use: sim2d, {world}"))
    (folder / "mission.yaml").write_text(
        MISSION.replace("DRIVER", f"use: ros2, use_sim_time: true, stamped: true, {options}")
    )
    speed = f"{paced(0.7):.2f}"
    appearance = ("--namespace", "real", "--tf-topic", "tf", "--stamped", "--speed", speed)
    with (
        robot_in(folder / "robot.yaml", *appearance) as robot,
        Process("run", folder / "mission.yaml", "--headless", "--out", folder / "run") as mission,
    ):
        yield robot, mission


def stopped(
    relay: Relay,
    at: Callable[[Callable[[], None]], float],
    begin: Callable[[], None],
    end: Callable[[], None],
) -> tuple[float, str]:
    """After how many seconds of the ROS clock a fault makes the robot brake, and what is wrong with that.

    Args:
        at: calls ``begin`` at some moment, and says when that was.
        begin, end: of the fault.
    """
    relay.wait_for_speed(MOVING_MPS, 60.0)
    begin_s = at(begin)
    rests = relay.wait_for_rest(begin_s, 30.0)
    end()
    sent = [(sent_s, abs(v)) for sent_s, v, _ in relay.commands if sent_s >= begin_s - 0.2]
    if not rests:
        return math.inf, f"not at rest: {sent}"
    rest = next(n for n, (sent_s, v) in enumerate(sent) if sent_s > begin_s and v == 0.0)
    cruising = [n for n in range(1, rest) if sent[n][1] >= sent[n - 1][1]]
    brake_s = sent[cruising[-1] + 1 if cruising else 0][0]
    return brake_s - begin_s, ""


def test_every_fault_of_a_topic_stops_the_robot_with_its_reason_and_it_goes_on(relay, tmp_path):
    def setting(topic, how):
        return lambda: setattr(relay, topic, how)

    def spoiling(topic, how):
        return setting(topic, how), setting(topic, spoilt.passed)

    faults = {
        "/scan: nothing good for": spoiling("scan", spoilt.silent),
        "in the future": spoiling("scan", spoilt.later(5.0)),
        "its stamp is": spoiling("scan", spoilt.later(-3.0)),
        "its stamp has gone back": spoiling("scan", spoilt.running_back()),
        'nothing on tf ties its frame "laser_2" to base_link': spoiling("scan", spoilt.in_frame("laser_2")),
        'its frame "odom" is not on the robot': spoiling("scan", spoilt.in_frame("odom")),
        'its frame "laser" has jumped': (lambda: relay.place_laser(0.4), lambda: relay.place_laser(0.0)),
        "tf odom → base_link: nothing good for": spoiling("tf", spoilt.silent),
        "it jumped by 2.0": (setting("tf", spoilt.jumped(2.0)), lambda: None),
        "the emergency stop is pressed": (lambda: relay.press(True), lambda: relay.press(False)),
    }
    with mission_of(tmp_path, 'odom_topic: ""') as (robot, mission):
        found = {
            words: stopped(relay, lambda fault: relay.right_after_a_scan(fault, 30.0), *fault)
            for words, fault in faults.items()
        }
        relay.wait_for_speed(MOVING_MPS, 60.0)
        relay.scan = spoilt.flood
        count = len(relay.commands)
        until(lambda: len(relay.commands) > count + 20, 20.0, "commands go on in a flood of scans")
        relay.wait_for_speed(MOVING_MPS, 60.0)
        code = mission.end(signal.SIGTERM)
        until(lambda: relay.commands[-1][1:] == (0.0, 0.0), 5.0, "the last command is a zero")
        robot.end()
    (tmp_path / "found.json").write_text(json.dumps(found, indent=2))
    assert {words: fault for words, (_, fault) in found.items() if fault} == {}
    assert {words: took_s for words, (took_s, _) in found.items() if took_s > STOP_S} == {}
    assert "0 contacts" in robot.text
    assert code == 130, mission.text
    told = reasons(tmp_path / "run" / "recording.mcap")
    for words in faults:
        assert any(words in line for line in told), f"{words!r} in {told}"


def lidar_node(*words: str) -> AbstractContextManager[subprocess.Popen[str]]:
    return stand_in_process(Path(__file__).with_name("scan_node.py"), *words)


@pytest.mark.slow
@pytest.mark.parametrize("relay", [False], indirect=True, ids=["scans by a node"])
def test_a_lidar_that_is_killed_stops_the_robot_and_one_that_comes_back_with_other_qos_is_told(
    relay, tmp_path
):
    with lidar_node() as lidar, mission_of(tmp_path, "reliability: reliable") as (robot, mission):

        def now(fault: Callable[[], None]) -> float:
            fault()
            return relay.now_s()

        took_s, fault = stopped(relay, now, lidar.kill, lidar.wait)
        assert (took_s <= STOP_S, fault) == (True, ""), took_s
        with lidar_node("best_effort"):
            until_told = relay.now_s() + 3.0
            until(lambda: relay.now_s() > until_told, 60.0, "three seconds of the robot's clock")
            assert all(sent[1:] == (0.0, 0.0) for sent in relay.commands[-10:])
        with lidar_node():
            relay.wait_for_speed(MOVING_MPS, 60.0)
            mission.end(signal.SIGTERM)
        robot.end()
    told = reasons(tmp_path / "run" / "recording.mcap")
    assert any("QoS mismatch: the other side offers another reliability" in line for line in told), told


def test_a_mission_that_is_killed_leaves_a_robot_that_stands(relay, tmp_path):
    (tmp_path / "hall.yaml").write_text(HALL)
    script = """
from explore_bt.interfaces import RobotContext
from explore_bt.types import Twist2
from explore_bt_ros2.driver import Ros2
from explore_bt_ros2.options import Ros2Options
driver = Ros2(Ros2Options(stamped=True))
driver.setup(RobotContext())
while True:
    driver.command(Twist2(0.3, 0.0))
    driver.clock.wait_until(driver.clock.now_s() + 0.05)
"""
    with robot_in(tmp_path / "hall.yaml", "--namespace", "real", "--wall-time", "--stamped"):
        mission = subprocess.Popen([sys.executable, "-c", script])
        relay.wait_for_speed(0.3, 20.0)
        count = len(relay.odometry)
        until(lambda: len(relay.odometry) > count + 20, 5.0, "a second of driving")
        mission.kill()
        mission.wait()
        killed_s = time.time()
        until(lambda: relay.odometry[-1][0] > killed_s + 2.2, 5.0, "odometry goes on")
        rest = [(x, y) for stamp_s, x, y in relay.odometry if stamp_s > killed_s + 1.7]
        assert math.dist(rest[0], rest[-1]) < 0.005


def test_a_robot_that_dies_and_comes_back_is_told_from_one_whose_qos_does_not_fit(tmp_path):
    (tmp_path / "hall.yaml").write_text(HALL)
    driver = Ros2(Ros2Options())
    strict = Ros2(Ros2Options(reliability="reliable"))

    def faults() -> str:
        driver.read()
        return driver.hindrance()

    try:
        with robot_in(tmp_path / "hall.yaml", "--wall-time") as robot:
            driver.setup(RobotContext())
            until(lambda: not faults(), 5.0, driver.hindrance())
            strict.setup(RobotContext())
            assert "QoS mismatch: the other side offers another reliability" in strict.hindrance()
            robot.run.kill()
            robot.run.wait()
            killed_s = time.monotonic()
            until(faults, 2.0, "a dead robot is noticed")
            assert time.monotonic() - killed_s < STOP_S + SLACK_S
        with robot_in(tmp_path / "hall.yaml", "--wall-time"):
            until(lambda: not faults(), 10.0, driver.hindrance())
    finally:
        driver.close()
        strict.close()


def test_a_clock_that_stands_is_a_fault_and_waiting_for_it_is_not_for_ever(tmp_path):
    (tmp_path / "hall.yaml").write_text(HALL)
    driver = Ros2(Ros2Options(use_sim_time=True))

    def faults() -> str:
        driver.read()
        return driver.hindrance()

    with robot_in(tmp_path / "hall.yaml", "--speed", "2") as robot:
        driver.setup(RobotContext())
        try:
            until(lambda: not faults(), 5.0, driver.hindrance())
            robot.run.send_signal(signal.SIGSTOP)
            stopped_s = time.monotonic()
            until(lambda: "/clock is silent" in faults(), 2.0, "a clock that stands is noticed")
            assert time.monotonic() - stopped_s < STOP_S + SLACK_S
            now_s = driver.clock.now_s()
            driver.clock.wait_until(now_s + 0.2)
            robot.run.send_signal(signal.SIGCONT)
            until(lambda: not faults(), 5.0, "it goes on")
            assert driver.clock.now_s() >= now_s + 0.2
        finally:
            robot.run.send_signal(signal.SIGCONT)
            driver.close()
