"""A fleet of real processes on bad networks, and when some of it is killed.

    python benchmarks/fleet_network.py [CASE...] [--out DIR]

Two simulated robots explore the flat, each in its own process, over Zenoh. ``loopback`` is this machine's
own network; ``bad`` and ``cut`` go over a cable between two network namespaces, with 200 ms each way, a loss
of 10 % and 50 kB/s, the second with 30 s in which nothing comes through. In the others somebody is killed.
"""

from __future__ import annotations

import argparse
import json
import signal
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
from cable import Cable, CableError, Trouble, cable
from fleet_processes import Fleet, Track, apart_m, doubly_claimed_s, free_port, running
from machine import ROOT, describe_machine

from explore_bt.maps import read_map
from explore_bt.mission import load_mission
from explore_bt.plugin import load_plugins
from explore_bt.recording import read_recording
from explore_bt.runtime import StopFlag, run_mission
from explore_bt.types import OccupancyGrid

PATIENCE_S = 900.0
RADIUS_M = 0.25
TIMEOUT_S = 5.0
CUT_AT_S, CUT_S = 20.0, 30.0
_HERE = "127.0.0.1"
AWAITED = "awaited"
BAD = Trouble(delay_s=0.2, loss=0.1, rate_bytes_per_s=50_000.0)
MISSION = """\
format: explore-bt/1
name: fleet
include: [trees/complete.yaml]
robots:
  ada: {start: ADA, ROBOT}
  bob: {start: BOB, ROBOT}
team: {use: zenoh, multicast: false, TEAM}
limits: {time: 20 min}
tree: complete
"""
ROBOT = (
    "driver: {use: sim2d, world: world.yaml, radius: 0.25 m, lidar_range: 5 m}, "
    "slam: ground_truth, planner: skeleton, controller: pursuit"
)
CORRIDOR = """\
format: explore-bt-world/1
rooms:
  - {name: west, box: [0, 0, 4, 4]}
  - {name: corridor, box: [4, 1.5, 12, 2.5]}
  - {name: east, box: [12, 0, 16, 4]}
doors: [{name: w, at: [4, 2], width: 0.9}, {name: e, at: [12, 2], width: 0.9}]
start: [2, 2, 0]
"""
MEET = """\
format: explore-bt/1
name: meet
include: [trees/shared.yaml]
robots:
  ada: {start: [2 m, 2 m, 0 deg], tree: to_east, map: known/slam, ROBOT}
  bob: {start: [14 m, 2 m, 180 deg], tree: to_west, map: known/slam, ROBOT}
team: {use: zenoh, multicast: false, connect: [$env.FLEET_CONNECT], listen: [$env.FLEET_LISTEN]}
limits: {time: 5 min}
trees:
  to_east: {sequence: [choose_place: {x: 14, y: 2}, subtree: reach_goal]}
  to_west: {sequence: [choose_place: {x: 2, y: 2}, subtree: reach_goal]}
"""
STARTS = {"ADA": "[3.3 m, 3.6 m, 0 deg]", "BOB": "[3.3 m, 2.6 m, 0 deg]"}


@dataclass(frozen=True, slots=True)
class Row:
    """What came of one case.

    Attributes:
        end_s: of the machine's time, from the first tick to the last.
        known: share of the reachable floor in the map of each robot.
        differ: share of the cells both know of which one says free and the other occupied.
        lacks_m2: floor that only one of the two maps has.
        silent_s: how long they did not hear each other: from the cut or the kill on.
        double_s: the longest time for which both had claimed the same; while they heard each other.
        cut_off_double_s: the same in the cut.
        closest_m: between their edges; the same two.
        words_s: age of words by the robots' own bound, mean.
        sent_bytes_per_s: by each robot, mean over the run: all that went into the cable, else what it told.
    """

    case: str
    outcome: str
    end_s: float
    contacts: int
    known: tuple[float, ...]
    differ: float
    lacks_m2: float
    silent_s: float
    double_s: float
    cut_off_double_s: float
    closest_m: float
    cut_off_closest_m: float
    words_s: str
    sent_bytes_per_s: tuple[float, ...]


Doings = Callable[[Fleet, Cable | None], tuple[float, float]]
"""What is done to a fleet that runs: until all is over; begin and end of what kept them apart."""


@dataclass(frozen=True, slots=True)
class Case:
    """A network, and what happens on it."""

    doings: Doings
    trouble: Trouble | None = None
    team: str = "connect: [$env.FLEET_CONNECT], listen: [$env.FLEET_LISTEN]"


def main() -> None:
    """Run the cases and print a line of the table for each."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("cases", nargs="*", default=[*CASES, AWAITED], metavar="CASE")
    parser.add_argument("--out", type=Path, default=None)
    given = parser.parse_args()
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))  # so that no process and no namespace is left
    out = given.out or Path(tempfile.mkdtemp(prefix="fleet-network-"))
    print(f"{describe_machine()}\nruns in {out}")
    for name in given.cases:
        if name == AWAITED:
            print(_awaited(out / name), flush=True)
            continue
        try:
            row = _run(name, out / name)
        except CableError as fault:
            print(f"{name}: left out, {fault}")
            continue
        with (out / "rows.jsonl").open("a") as file:
            file.write(json.dumps(asdict(row)) + "\n")
        print(_line(row), flush=True)


def _run(name: str, folder: Path) -> Row:
    case = CASES[name]
    with _laid(case.trouble) as laid:
        fleet = Fleet.of(folder, _mission(case.team), {"world.yaml": _world()})
        _introduce(fleet, laid.addresses if laid else (_HERE, _HERE))
        with running(fleet):
            apart = case.doings(fleet, laid)
        begun_s = min(fleet.track(robot).times_s[0] for robot in ("ada", "bob"))
        spent_s = max(fleet.track(robot).times_s[-1] for robot in ("ada", "bob")) - begun_s
        sent = tuple(each / spent_s for each in laid.sent_bytes) if laid else ()
    return _row(name, fleet, apart, sent)


def _introduce(fleet: Fleet, hosts: Sequence[str]) -> None:
    ends = [f"{host}:{free_port()}" for host in hosts]
    for robot, own, other in (("ada", *ends), ("bob", *ends[::-1])):
        fleet.environs[robot] = {
            "FLEET_LISTEN": f"tcp/{own}",
            "FLEET_CONNECT": f"tcp/{other}",
        }


def _awaited(folder: Path) -> str:
    """Two meet in a corridor; the one that goes first is killed while the other waits for it."""
    fleet = Fleet.of(folder, MEET.replace("ROBOT", ROBOT), {"world.yaml": CORRIDOR})
    alone = MISSION.replace("ROBOT", ROBOT).replace("ADA", "[2 m, 2 m, 0 deg]").partition("  bob:")[0]
    (folder / "explore.yaml").write_text(f"{alone}tree: complete\n")
    registry = load_plugins().registry
    mission = load_mission(folder / "explore.yaml", registry)
    run_mission(mission, registry=registry, out=folder / "known", seed=0, sinks=(), stop=StopFlag())
    _introduce(fleet, (_HERE, _HERE))
    with running(fleet):
        _start(fleet, None)
        _until(lambda: any(words.startswith("team mate ada") for words in fleet.track("bob").gate), 120.0)
        _until(lambda: _driven_s(fleet, "bob") > _held_s(fleet.track("bob")) + 3.0)
        fleet.kill("ada")
        killed_s = time.monotonic()
        fleet.wait(["bob"], PATIENCE_S)
        came_s = fleet.track("bob").times_s[-1] - killed_s
        fleet.resume("ada")
        fleet.wait(["ada"], PATIENCE_S)
    ends = [fleet.track(robot).places[-1] for robot in ("ada", "bob")]
    return (
        f"awaited: bob waited for ada, who was killed; it came to ({ends[1][0]:.1f}, {ends[1][1]:.1f}) "
        f"{came_s:.0f} s later; ada, resumed, to ({ends[0][0]:.1f}, {ends[0][1]:.1f}); "
        + " ".join(str(fleet.result(robot)["outcome"]) for robot in ("ada", "bob"))
    )


def _held_s(track: Track) -> float:
    """When it was first held for ada."""
    first = next(index for index, words in enumerate(track.gate) if words.startswith("team mate ada"))
    return float(track.stamps_s[first])


@contextmanager
def _laid(trouble: Trouble | None) -> Iterator[Cable | None]:
    if trouble is None:
        yield None
        return
    with cable(trouble) as laid:
        yield laid


def _mission(team: str) -> str:
    text = MISSION.replace("ROBOT", ROBOT).replace("TEAM", team)
    for name, start in STARTS.items():
        text = text.replace(name, start)
    return text


def _world() -> str:
    return (ROOT / "missions" / "worlds" / "apartment.yaml").read_text()


# --- what happens to the fleet ---------------------------------------------------------------------------


def _start(fleet: Fleet, laid: Cable | None) -> None:
    for side, robot in enumerate(("ada", "bob")):
        fleet.start(robot, laid.spaces[side] if laid else "")


def _until(is_so: Callable[[], bool], patience_s: float = PATIENCE_S) -> None:
    end_s = time.monotonic() + patience_s
    while not is_so():
        if time.monotonic() > end_s:
            raise TimeoutError("what was waited for has not come")
        time.sleep(0.1)


def _driven_s(fleet: Fleet, robot: str) -> float:
    stamps = fleet.track(robot).stamps_s
    return float(stamps[-1]) if len(stamps) else -1.0


def _let_be(fleet: Fleet, laid: Cable | None) -> tuple[float, float]:
    _start(fleet, laid)
    fleet.wait(("ada", "bob"), PATIENCE_S)
    return (0.0, 0.0)


def _cut(fleet: Fleet, laid: Cable | None) -> tuple[float, float]:
    assert laid is not None  # the case has one
    _start(fleet, laid)
    _until(lambda: min(_driven_s(fleet, robot) for robot in ("ada", "bob")) > CUT_AT_S)
    begin_s = time.monotonic()
    laid.is_cut = True
    time.sleep(CUT_S)
    laid.is_cut = False
    end_s = time.monotonic()
    fleet.wait(("ada", "bob"), PATIENCE_S)
    return (begin_s, end_s)


def _kill_one(fleet: Fleet, laid: Cable | None) -> tuple[float, float]:
    """Bob dies and comes back ten seconds later."""
    _start(fleet, laid)
    _until(lambda: _driven_s(fleet, "bob") > CUT_AT_S)
    fleet.kill("bob")
    begin_s = time.monotonic()
    time.sleep(10.0)
    fleet.resume("bob")
    before = len(fleet.track("bob").times_s)
    _until(lambda: len(fleet.track("bob").times_s) > before)
    end_s = time.monotonic()
    fleet.wait(("ada", "bob"), PATIENCE_S)
    return (begin_s, end_s)


def _kill_router(fleet: Fleet, laid: Cable | None) -> tuple[float, float]:
    """It dies and comes back fifteen seconds later."""
    endpoint = fleet.environs["ada"]["FLEET_LISTEN"]
    fleet.environs = {robot: {"FLEET_CONNECT": endpoint} for robot in fleet.environs}
    words = ("router", "--listen", endpoint)
    fleet.spawn("router", words)
    _until(lambda: "is passed on" in (fleet.folder / "router.out").read_text())
    _start(fleet, laid)
    _until(lambda: min(_driven_s(fleet, robot) for robot in ("ada", "bob")) > CUT_AT_S)
    fleet.kill("router")
    begin_s = time.monotonic()
    time.sleep(15.0)
    fleet.spawn("router", words)
    _until(lambda: (fleet.folder / "router.out").read_text().count("is passed on") == 2)
    end_s = time.monotonic()
    fleet.wait(("ada", "bob"), PATIENCE_S)
    return (begin_s, end_s)


# --- figures ---------------------------------------------------------------------------------------------


def _row(name: str, fleet: Fleet, apart: tuple[float, float], sent: tuple[float, ...]) -> Row:
    results = [fleet.result(robot) for robot in ("ada", "bob")]
    ada, bob = (fleet.track(robot) for robot in ("ada", "bob"))
    differ, lacks_m2 = _compared(*(read_map(fleet.folder / robot / "map.yaml") for robot in ("ada", "bob")))
    back_s = max(_back_s(fleet, "ada", "bob"), _back_s(fleet, "bob", "ada")) if apart[1] else 0.0
    heard, cut_off = _times(ada, bob, apart, back_s)
    told = [_told(fleet.folder / robot) for robot in ("ada", "bob")]
    return Row(
        case=name,
        outcome=" ".join(str(result["outcome"]) for result in results),
        end_s=float(max(ada.times_s[-1], bob.times_s[-1]) - min(ada.times_s[0], bob.times_s[0])),
        contacts=sum(int(result["contacts"]) for result in results),
        known=tuple(float(result["coverage"]) for result in results),
        differ=differ,
        lacks_m2=lacks_m2,
        silent_s=max(back_s - apart[0], 0.0),
        double_s=max(doubly_claimed_s(ada, bob, span) for span in heard),
        cut_off_double_s=doubly_claimed_s(ada, bob, cut_off),
        closest_m=min(_closest_m(ada, bob, span) for span in heard),
        cut_off_closest_m=_closest_m(ada, bob, cut_off),
        words_s=" ".join(words.partition("words came ")[2].partition(" s old")[0] for words in told),
        sent_bytes_per_s=sent or tuple(_bytes_per_s(words) for words in told),
    )


def _times(
    ada: Track, bob: Track, apart: tuple[float, float], back_s: float
) -> tuple[list[np.ndarray], np.ndarray]:
    """When they heard each other, and when they did not: ten a second."""
    begin_s, end_s = max(ada.times_s[0], bob.times_s[0]), min(ada.times_s[-1], bob.times_s[-1])
    if apart[1] == 0.0:
        return [np.arange(begin_s, end_s, 0.1)], np.empty(0)
    again_s = max(apart[1], back_s)
    cut_off = np.arange(apart[0], again_s, 0.1)
    return [np.arange(begin_s, apart[0], 0.1), np.arange(again_s, end_s, 0.1)], cut_off


def _back_s(fleet: Fleet, robot: str, mate: str) -> float:
    """When a robot heard a mate again, or for the first time."""
    recording, track = read_recording(fleet.folder / robot / "recording.mcap"), fleet.track(robot)
    words = f"robot {mate} is there"
    stamps = [each.stamp_s for each in recording.messages("/events") if each.value["message"] == words]
    return float(track.times_s[np.flatnonzero(track.stamps_s <= stamps[-1])[-1]])


def _closest_m(one: Track, other: Track, times_s: np.ndarray) -> float:
    apart = apart_m(one, other, times_s)
    known = apart[np.isfinite(apart)]
    return float(known.min()) - 2.0 * RADIUS_M if len(known) else float("nan")


def _compared(one: OccupancyGrid, other: OccupancyGrid) -> tuple[float, float]:
    """Share of contradictions in what both know, and area that only one of them knows."""
    places = np.argwhere(one.cells >= 0)
    at = other.cells_of(one.centers_of(places))
    inside = np.all((at >= 0) & (at < other.shape), axis=1)
    rows, cols = np.where(inside[:, None], at, 0).T
    theirs = np.where(inside, other.cells[rows, cols], -1)
    mine = one.cells[places[:, 0], places[:, 1]]
    both = theirs >= 0
    differ = float(((mine > 0) != (theirs > 0))[both].mean())
    lacking = np.count_nonzero(~both) + np.count_nonzero(other.cells >= 0) - np.count_nonzero(both)
    return differ, lacking * one.resolution_m**2


def _told(folder: Path) -> str:
    events = [
        message.value["message"] for message in read_recording(folder / "recording.mcap").messages("/events")
    ]
    return next(str(words) for words in reversed(events) if str(words).startswith("told presence"))


def _bytes_per_s(told: str) -> float:
    return 1000.0 * sum(float(part.split()[-2]) for part in told.partition(" of ")[0].split(","))


def _line(row: Row) -> str:
    cells = [
        row.case,
        row.outcome,
        f"{row.end_s:.0f} s",
        str(row.contacts),
        " ".join(f"{100 * share:.1f} %" for share in row.known),
        f"{100 * row.differ:.2f} %",
        f"{row.lacks_m2:.2f} m²",
        f"{row.silent_s:.0f} s",
        f"{row.double_s:.1f} s",
        f"{row.cut_off_double_s:.1f} s",
        f"{row.closest_m:.2f} m",
        f"{row.cut_off_closest_m:.2f} m",
        row.words_s,
        " ".join(f"{each / 1000.0:.1f}" for each in row.sent_bytes_per_s),
    ]
    return f"| {' | '.join(cells)} |"


_CLIENTS = "mode: client, connect: [$env.FLEET_CONNECT]"
CASES: dict[str, Case] = {
    "loopback": Case(_let_be),
    "bad": Case(_let_be, BAD),
    "cut": Case(_cut, BAD),
    "killed": Case(_kill_one),
    "router": Case(_kill_router, team=_CLIENTS),
}

if __name__ == "__main__":
    main()
