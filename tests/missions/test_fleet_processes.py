"""A process for each robot, over Zenoh on loopback."""

import json
import os
import shutil
import socket
import subprocess
import sys
import time
from pathlib import Path

import pytest

from explore_bt.maps import read_map

from .conftest import MISSIONS

pytest.importorskip("zenoh", reason="eclipse-zenoh is not installed")
EXPLORE_BT = Path(sys.executable).with_name("explore-bt")
WORLD = """\
format: explore-bt-world/1
rooms:
  - {name: west, box: [0, 0, 5, 4]}
  - {name: east, box: [5, 0, 10, 4]}
doors: [{name: door, at: [5, 2], width: 1.2}]
"""
ROBOT = """\
    driver: {use: sim2d, world: two.yaml, radius: 0.25 m, lidar_range: 3 m}
    slam: ground_truth
    planner: skeleton
    controller: pursuit
    tree: complete
"""
LATE_S = 240.0


def free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


@pytest.fixture
def fleet(tmp_path: Path) -> Path:
    """A mission whose robots meet at one end of a port: the first of them listens there."""
    shutil.copytree(MISSIONS / "trees", tmp_path / "trees")
    (tmp_path / "two.yaml").write_text(WORLD)
    port = free_port()
    (tmp_path / "fleet.yaml").write_text(
        "format: explore-bt/1\nname: fleet\ninclude: [trees/complete.yaml]\n"
        f"robots:\n  ada:\n    start: [2 m, 2 m, 180 deg]\n{ROBOT}"
        f"  bob:\n    start: [8 m, 2 m, 0 deg]\n{ROBOT}"
        "team: {use: zenoh, multicast: false, fleet: test, "
        f"connect: [$env.FLEET_CONNECT], listen: [$env.FLEET_LISTEN]}}\n"
        "limits: {time: 5 min}\n"
    )
    (tmp_path / "port").write_text(str(port))
    return tmp_path


def started(folder: Path, robot: str, connect: str, listen: str) -> subprocess.Popen[str]:
    command = [EXPLORE_BT, "run", folder / "fleet.yaml", "--robot", robot, "--headless", "--pace", "3"]
    environ = {**os.environ, "FLEET_CONNECT": connect, "FLEET_LISTEN": listen}
    return subprocess.Popen(
        [*command, "--out", folder / robot],
        env=environ,
        text=True,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
    )


def test_two_processes_divide_the_floor_and_both_bring_home_all_of_it(fleet: Path) -> None:
    """Each has seen its room; the rest it knows from the other."""
    ports = (fleet / "port").read_text(), str(free_port())
    ends = [f"tcp/127.0.0.1:{port}" for port in ports]
    runs = {
        "ada": started(fleet, "ada", ends[1], ends[0]),
        "bob": started(fleet, "bob", ends[0], ends[1]),
    }
    deadline_s = time.monotonic() + LATE_S
    told = {
        name: run.communicate(timeout=max(deadline_s - time.monotonic(), 1.0))[0]
        for name, run in runs.items()
    }
    results = {name: json.loads((fleet / name / "result.json").read_text()) for name in runs}
    assert [result["outcome"] for result in results.values()] == ["explored", "explored"], told
    assert all(result["contacts"] == 0 for result in results.values())
    assert all(result["coverage"] > 0.97 for result in results.values()), "as the team knows it"
    free_m2 = [(read_map(fleet / name / "map.yaml").free.sum()) * 0.05**2 for name in runs]
    assert max(free_m2) < 0.97 * 40.0, "neither has seen all of it itself"
