"""A process for each robot, over Zenoh on loopback; bad networks are for benchmarks/fleet_network.py."""

import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from fleet_processes import Fleet, free_port, running

from explore_bt.maps import read_map
from explore_bt.recording import read_recording

pytest.importorskip("zenoh", reason="eclipse-zenoh is not installed")
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
MISSION = f"""\
format: explore-bt/1
name: fleet
include: [trees/complete.yaml]
robots:
  ada:
    start: [2 m, 2 m, 180 deg]
{ROBOT}
  bob:
    start: [8 m, 2 m, 0 deg]
{ROBOT}
team: {{use: zenoh, multicast: false, connect: [$env.FLEET_CONNECT], listen: [$env.FLEET_LISTEN]}}
limits: {{time: 5 min}}
"""
LATE_S = 240.0
BOTH = ("ada", "bob")


@pytest.fixture
def fleet(tmp_path: Path) -> Iterator[Fleet]:
    """Each listens at a port of its own and goes to the other's; none of its processes outlives the test."""
    fleet = Fleet.of(tmp_path, MISSION, {"two.yaml": WORLD}, pace=3.0)
    ends = [f"tcp/127.0.0.1:{free_port()}" for _ in BOTH]
    for robot, own, other in (("ada", *ends), ("bob", *ends[::-1])):
        fleet.environs[robot] = {"FLEET_LISTEN": own, "FLEET_CONNECT": other}
    with running(fleet):
        yield fleet


def until(is_so: Callable[[], bool], fleet: Fleet) -> None:
    end_s = time.monotonic() + LATE_S
    while not is_so():
        assert time.monotonic() < end_s, fleet.said()
        time.sleep(0.05)


def events(fleet: Fleet, robot: str) -> list[str]:
    recording = read_recording(fleet.folder / robot / "recording.mcap")
    return [str(message.value["message"]) for message in recording.messages("/events")]


def free_m2(fleet: Fleet, *where: str) -> float:
    return float(read_map(fleet.folder.joinpath(*where, "map.yaml")).free.sum()) * 0.05**2


def test_two_processes_divide_the_floor_and_both_bring_home_all_of_it(fleet: Fleet) -> None:
    """Each has seen its room; the rest it knows from the other."""
    for robot in BOTH:
        fleet.start(robot)
    fleet.wait(BOTH, LATE_S)
    results = [fleet.result(robot) for robot in BOTH]
    assert [result["outcome"] for result in results] == ["explored", "explored"], fleet.said()
    assert all(result["contacts"] == 0 for result in results)
    assert all(result["coverage"] > 0.97 for result in results), "as the team knows it"
    assert max(free_m2(fleet, robot, robot) for robot in BOTH) < 0.97 * 40.0, "neither has seen all itself"
    of_all = [free_m2(fleet, robot) for robot in BOTH]
    assert of_all[0] == pytest.approx(of_all[1], abs=0.2)
    assert min(of_all) > 0.95 * 38.0


def test_a_robot_that_is_killed_goes_on_from_its_checkpoint_and_rejoins(fleet: Fleet) -> None:
    """The other takes over what it had claimed, and hears it again."""
    for robot in BOTH:
        fleet.start(robot)
    until(lambda: len(fleet.track("bob").claims) > 0 and fleet.track("bob").stamps_s[-1] > 7.0, fleet)
    fleet.kill("bob")
    before = fleet.track("bob")
    fleet.resume("bob")
    fleet.wait(BOTH, LATE_S)
    assert [fleet.result(robot)["outcome"] for robot in BOTH] == ["explored", "explored"], fleet.said()
    assert all(fleet.result(robot)["coverage"] > 0.97 for robot in BOTH)
    assert all(fleet.result(robot)["contacts"] == 0 for robot in BOTH)
    heard = [
        words for words in events(fleet, "ada") if words.startswith("robot bob") and "merged" not in words
    ]
    assert heard[:3] == [
        "robot bob is there",
        "robot bob is silent: what it had claimed is free",
        "robot bob is there",
    ]
    again_s = fleet.track("bob").stamps_s[len(before.stamps_s)]
    assert before.stamps_s[-1] - 2.0 < again_s < before.stamps_s[-1] + 1.0, "not from the beginning"
    assert any(words.startswith("part 2 begins") for words in events(fleet, "bob"))
    assert free_m2(fleet, "ada") == pytest.approx(free_m2(fleet, "bob"), abs=0.2)
