"""The network between robot and mission is cut and mended: two network namespaces and a cable."""

from __future__ import annotations

from tests.ros2 import ros  # isort: skip  # noqa: F401

import os
import shutil
import subprocess
import sys
import time
from collections.abc import Iterator

import pytest

from tests.ros2.processes import until
from tests.ros2.worlds import HALL

STOP_S = 0.3
SLACK_S = 0.15
_LISTENER = """
import sys, time
from explore_bt.interfaces import RobotContext
from explore_bt_ros2.driver import Ros2
from explore_bt_ros2.options import Ros2Options
driver = Ros2(Ros2Options(discovery="subnet"))
driver.setup(RobotContext())
before = None
while True:
    driver.clock.wait_until(driver.clock.now_s() + 0.02)
    driver.read()
    fault = driver.hindrance()
    if bool(fault) != before:
        before = bool(fault)
        print(time.monotonic(), fault or "fine", flush=True)
"""


def ip(*words: str) -> bool:
    return subprocess.run(["ip", *words], capture_output=True, check=False).returncode == 0


@pytest.fixture
def names() -> Iterator[tuple[str, str]]:
    """Two namespaces joined by a cable; the cable's near end has the name of the first."""
    if shutil.which("ip") is None or os.geteuid() != 0:
        pytest.skip("cutting a network needs ip and root")
    one, two = (f"ebt{os.getpid() % 10000}{side}" for side in "ab")
    made = ip("netns", "add", one) and ip("netns", "add", two)
    made = made and ip("link", "add", one, "netns", one, "type", "veth", "peer", "name", two, "netns", two)
    for number, name in enumerate((one, two), 1):
        made = made and ip("-n", name, "addr", "add", f"10.77.0.{number}/24", "dev", name)
        made = (
            made and ip("-n", name, "link", "set", name, "up") and ip("-n", name, "link", "set", "lo", "up")
        )
    if not made:
        ip("netns", "del", one), ip("netns", "del", two)
        pytest.skip("this machine lets nobody make network namespaces")
    yield one, two
    ip("netns", "del", one)
    ip("netns", "del", two)


@pytest.mark.slow
def test_a_cut_cable_stops_the_robot_and_a_mended_one_lets_it_go_on(names, tmp_path):
    (tmp_path / "hall.yaml").write_text(HALL)
    environment = {
        **os.environ,
        "FASTDDS_BUILTIN_TRANSPORTS": "UDPv4",  # shared memory needs no cable
        "ROS_AUTOMATIC_DISCOVERY_RANGE": "SUBNET",
        "PYTHONUNBUFFERED": "1",
    }
    sim = "from explore_bt.cli import main; main()"
    said, heard = ((tmp_path / name).open("w") for name in ("said.txt", "heard.txt"))
    robot = subprocess.Popen(
        [
            *("ip", "netns", "exec", names[0], sys.executable, "-c", sim, "ros2-sim"),
            tmp_path / "hall.yaml",
            "--wall-time",
        ],
        env=environment,
        stdout=said,
    )
    listener = subprocess.Popen(
        ["ip", "netns", "exec", names[1], sys.executable, "-c", _LISTENER], env=environment, stdout=heard
    )

    def lines() -> list[str]:
        return (tmp_path / "heard.txt").read_text().splitlines()

    try:
        until(
            lambda: "is on ROS 2" in (tmp_path / "said.txt").read_text(),
            90.0,
            "the robot has loaded its kernels",
        )
        until(lambda: lines() and lines()[-1].endswith("fine"), 30.0, "the robot is heard over the cable")
        cut_s = time.monotonic()
        assert ip("-n", names[0], "link", "set", names[0], "down")
        until(lambda: not lines()[-1].endswith("fine"), 5.0, "silence is noticed")
        told_s, _, words = lines()[-1].partition(" ")
        assert float(told_s) - cut_s < STOP_S + SLACK_S
        assert "/scan: nothing good for" in words
        assert ip("-n", names[0], "link", "set", names[0], "up")
        until(lambda: lines()[-1].endswith("fine"), 20.0, "it goes on")
    finally:
        for process in (robot, listener):
            process.kill()
            process.wait()
        said.close()
        heard.close()
