"""The network between robot and mission is cut and mended: two network namespaces and a cable."""

from __future__ import annotations

from tests.ros2 import ros  # isort: skip  # noqa: F401

import json
import os
import shutil
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.ros2.processes import until
from tests.ros2.worlds import HALL

STOP_S = 0.3
SPEED_MPS = 0.2
CUT_S = 3.0
_DRIVES = Path(__file__).with_name("drives.py")
_SIM = "from explore_bt.cli import main; main()"


def ip(*words: str) -> bool:
    return subprocess.run(["ip", *words], capture_output=True, check=False).returncode == 0


class Side:
    """A process in a namespace; what it says comes line by line."""

    def __init__(self, namespace: str, said: Path, *words: str | Path) -> None:
        environment = {
            **os.environ,
            "FASTDDS_BUILTIN_TRANSPORTS": "UDPv4",  # shared memory needs no cable
            "ROS_AUTOMATIC_DISCOVERY_RANGE": "SUBNET",
            "PYTHONUNBUFFERED": "1",
        }
        self._said = said
        with said.open("w") as file:
            self.run = subprocess.Popen(
                ["ip", "netns", "exec", namespace, sys.executable, *words], env=environment, stdout=file
            )

    @property
    def lines(self) -> list[str]:
        return self._said.read_text().splitlines()

    def close(self) -> None:
        self.run.kill()
        self.run.wait()


class Drive(Side):
    """``drives.py``, which drives ahead while it may and says in JSON what changes."""

    @property
    def news(self) -> list[dict]:
        return [json.loads(line) for line in self.lines if line.endswith("}")]

    def wait(self, fault: str, deadline_s: float) -> dict:
        """Until it says that it is so; empty: that it drives."""

        def is_said() -> bool:
            news = self.news
            return bool(news) and (fault in news[-1]["fault"] if fault else not news[-1]["fault"])

        until(is_said, deadline_s, fault or "it drives")
        return self.news[-1]


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
    sim = ("-c", _SIM, "ros2-sim", tmp_path / "hall.yaml", "--wall-time")
    robot = Side(names[0], tmp_path / "robot.txt", *sim)
    drive = Drive(names[1], tmp_path / "drive.txt", _DRIVES, str(SPEED_MPS))
    try:
        until(lambda: any("is on ROS 2" in line for line in robot.lines), 90.0, "its kernels are loaded")
        drive.wait("", 30.0)
        assert ip("-n", names[0], "link", "set", names[0], "down")
        cut_s = time.monotonic()
        cut = drive.wait("/scan: nothing good for", 5.0)
        assert cut["silent_s"] <= STOP_S + cut["late_s"]
        assert cut["sent_mps"] == 0.0
        until(lambda: time.monotonic() > cut_s + CUT_S, 2.0 * CUT_S, "the cut lasts")
        assert ip("-n", names[0], "link", "set", names[0], "up")
        back = drive.wait("", 20.0)
        assert back["sent_mps"] == SPEED_MPS
        assert back["x"] - cut["x"] < 0.5 * SPEED_MPS * CUT_S  # the base stood still by itself
    finally:
        robot.close()
        drive.close()
