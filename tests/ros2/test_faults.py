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
from itertools import pairwise
from pathlib import Path

import pytest
from explore_bt_ros2.driver import Ros2
from explore_bt_ros2.options import Ros2Options
from mcap.reader import make_reader

from explore_bt.interfaces import RobotContext
from tests.ros2 import relay as spoilt
from tests.ros2.processes import Process, until
from tests.ros2.relay import Relay
from tests.ros2.worlds import HALL, robot_in

MISSIONS = Path(__file__).parents[2] / "missions"
STOP_S = 0.3
SLACK_S = 0.15
"""Of a busy machine, over the judged figure."""
BRAKE_S = 1.6
MOVING_MPS = 0.2


@pytest.fixture
def relay() -> Iterator[Relay]:
    between = Relay()
    yield between
    between.close()


def reasons(recording: Path) -> set[str]:
    """All that the safety gate ever said."""
    with recording.open("rb") as file:
        found = make_reader(file).iter_messages(topics=["/robot/gate"])
        return {json.loads(message.data)["reason"] for _, _, message in found}


def spoil(relay: Relay, begin: Callable[[], None], end: Callable[[], None]) -> str:
    """Why the robot did not brake as it should while something was spoilt; empty if it did."""
    relay.wait_for_speed(MOVING_MPS, 40.0)
    begin_s = time.monotonic()
    begin()
    until_s = begin_s + STOP_S + SLACK_S + BRAKE_S
    while time.monotonic() < until_s:
        time.sleep(0.01)
    sent = [each for each in relay.commands if each[0] >= begin_s]
    end()
    after = [speed for stamp_s, speed, _ in sent if stamp_s >= begin_s + STOP_S + SLACK_S]
    if any(later > earlier + 1e-6 for earlier, later in pairwise(after)):
        return f"went faster: {after}"
    return "" if after and after[-1] == 0.0 else f"not at rest: {after}"


def test_every_fault_of_a_topic_stops_the_robot_with_its_reason_and_it_goes_on(relay, tmp_path):
    def set_scan(how):
        return lambda: setattr(relay, "scan", how)

    mend = set_scan(spoilt.passed)
    faults = {
        "/scan: nothing good for": (set_scan(spoilt.silent), mend),
        "in the future": (set_scan(spoilt.later(5.0)), mend),
        "its stamp is": (set_scan(spoilt.later(-3.0)), mend),
        "its stamp has gone back": (set_scan(spoilt.running_back()), mend),
        'nothing on tf ties its frame "laser_2" to base_link': (set_scan(spoilt.in_frame("laser_2")), mend),
        'its frame "laser" has jumped': (lambda: relay.place_laser(0.4), lambda: relay.place_laser(0.0)),
        "the emergency stop is pressed": (lambda: relay.press(True), lambda: relay.press(False)),
    }
    start = ["--set", "start=[3.3 m, 3.6 m, 0 deg]"]
    with robot_in(MISSIONS / "01_apartment.yaml", "--namespace", "real", "--wall-time", *start) as robot:
        words_of = ("run", MISSIONS / "06_ros2.yaml", "--headless", "--out", tmp_path / "run", *start)
        with Process(*words_of) as mission:
            wrong = {words: spoil(relay, begin, end) for words, (begin, end) in faults.items()}
            relay.wait_for_speed(MOVING_MPS, 40.0)
            relay.odom = spoilt.jumped(2.0)
            until(lambda: relay.commands[-1][1] == 0.0, 3.0, "a jump of the odometry stops the robot")
            relay.wait_for_speed(MOVING_MPS, 40.0)
            relay.scan = spoilt.flood
            count = len(relay.commands)
            until(lambda: len(relay.commands) > count + 20, 5.0, "commands go on in a flood of scans")
            relay.wait_for_speed(MOVING_MPS, 40.0)
            code = mission.end(signal.SIGTERM)
        until(lambda: relay.commands[-1][1:] == (0.0, 0.0), 2.0, "the last command is a zero")
    assert "0 contacts" in robot.text
    assert {words: fault for words, fault in wrong.items() if fault} == {}
    assert code == 130, mission.text
    told = reasons(tmp_path / "run" / "recording.mcap")
    for words in [*faults, "it jumped by 2.0"]:
        assert any(words in line for line in told), f"{words!r} in {told}"


def test_a_mission_that_is_killed_leaves_a_robot_that_stands(relay, tmp_path):
    (tmp_path / "hall.yaml").write_text(HALL)
    script = """
from explore_bt.interfaces import RobotContext
from explore_bt.types import Twist2
from explore_bt_ros2.driver import Ros2
from explore_bt_ros2.options import Ros2Options
driver = Ros2(Ros2Options())
driver.setup(RobotContext())
while True:
    driver.command(Twist2(0.3, 0.0))
    driver.clock.wait_until(driver.clock.now_s() + 0.05)
"""
    with robot_in(tmp_path / "hall.yaml", "--namespace", "real", "--wall-time"):
        mission = subprocess.Popen([sys.executable, "-c", script])
        relay.wait_for_speed(0.3, 20.0)
        count = len(relay.odometry)
        until(lambda: len(relay.odometry) > count + 20, 5.0, "a second of driving")
        mission.kill()
        mission.wait()
        killed_s = time.monotonic()
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
