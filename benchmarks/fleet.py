"""What is another robot worth?  python benchmarks/fleet.py MAP... [--robots 1 2 4] [--allocators auction].

Every map or world is explored by the tree ``complete`` with so many robots, which begin side by side at its
own start or its widest place. Results go to the file of ``--out``, one JSON line a run; what is in there
already is not driven again.
"""

from __future__ import annotations

import argparse
import json
import math
import tempfile
import time
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from explore_bt_drivers.world import World, load_world
from explore_bt_drivers.world.index import nearest
from machine import ROOT, describe_machine

from explore_bt.interfaces import Event, PluginOptions, RunInfo, Sink, TickSnapshot
from explore_bt.maps import read_map
from explore_bt.mission import load_mission
from explore_bt.plugin import load_plugins
from explore_bt.runtime import StopFlag, run_mission
from explore_bt.types import OccupancyGrid, Result

ENOUGH = 0.95
HEADER = (
    "| map | robots | allocator | slam | outcome | to 95 % | of one robot | end | total path | contacts "
    "| closest pair | map error | CPU per robot and tick |\n" + "|---" * 13 + "|"
)


class Stopwatch(Sink):
    """When how much was known, how far all have driven, how near they came to one another."""

    name = "stopwatch"
    api_version = 1

    def __init__(self) -> None:
        super().__init__(PluginOptions())
        self.enough_s: float | None = None
        self.path_m = 0.0
        self.closest_m = math.inf
        self.ticks = 0

    def open(self, run: RunInfo) -> None:
        """Nothing to get ready."""

    def on_tick(self, tick: TickSnapshot) -> None:
        """Coverage is that of the map of all, as each robot knows it."""
        self.ticks += 1
        self.path_m = sum(robot.score.distance_m for robot in tick.robots)
        if self.enough_s is None and max(robot.score.coverage or 0.0 for robot in tick.robots) >= ENOUGH:
            self.enough_s = tick.stamp_s
        places = np.array([robot.true_pose.xy for robot in tick.robots if robot.true_pose is not None])
        apart = np.hypot(*(places[:, None] - places[None]).transpose(2, 0, 1))[
            np.triu_indices(len(places), 1)
        ]
        self.closest_m = min(self.closest_m, float(apart.min()) if apart.size else math.inf)

    def on_event(self, event: Event) -> None:
        """Not counted."""

    def close(self, result: Result | None) -> None:
        """Nothing to let go of."""


def main() -> None:
    """Drive what is missing and print the table of all that was asked for."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("maps", nargs="+", type=Path)
    parser.add_argument("--robots", nargs="+", type=int, default=[1, 2, 4])
    parser.add_argument("--allocators", nargs="+", default=["auction"])
    parser.add_argument("--slam", default="ground_truth")
    parser.add_argument("--seeds", nargs="+", type=int, default=[0])
    parser.add_argument("--option", action="append", default=[], help="of the allocator: name=value")
    parser.add_argument("--out", type=Path, default=Path("fleet.jsonl"))
    arguments = parser.parse_args()
    done = (
        [json.loads(line) for line in arguments.out.read_text().splitlines()]
        if arguments.out.exists()
        else []
    )
    rows = []
    paths = {path.stem: path for path in arguments.maps}
    for case in _cases(arguments):
        known = next((each for each in done if each["case"] == case), None)
        if known is None:
            known = {"case": case, "machine": describe_machine(), **_driven(paths[case["map"]], case)}
            with arguments.out.open("a") as file:
                file.write(json.dumps(known) + "\n")
        rows.append(known)
    print(f"{describe_machine()}\n\n{HEADER}")
    for each in rows:
        print(_row(each, rows))


def _cases(arguments: argparse.Namespace) -> Iterator[dict[str, Any]]:
    for path in arguments.maps:
        for count in arguments.robots:
            for allocator in arguments.allocators if count > 1 else ["-"]:
                for seed in arguments.seeds:
                    yield {
                        "map": path.stem,
                        "robots": count,
                        "allocator": allocator,
                        "options": arguments.option if count > 1 else [],
                        "slam": arguments.slam,
                        "seed": seed,
                    }


def _driven(path: Path, case: dict[str, Any]) -> dict[str, Any]:
    """One run in this process."""
    registry, watch = load_plugins().registry, Stopwatch()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "trees").mkdir()
        for tree in (ROOT / "missions" / "trees").glob("*.yaml"):
            (folder / "trees" / tree.name).write_text(tree.read_text())
        (folder / "fleet.yaml").write_text(_mission(path.resolve(), case))
        mission = load_mission(folder / "fleet.yaml", registry)
        begun_s, out = time.process_time(), folder / "out"
        result = run_mission(
            mission, registry=registry, out=out, seed=case["seed"], sinks=[watch], stop=StopFlag()
        )
        cpu_s = time.process_time() - begun_s
        error_m = map_error_m(load_world(path), read_map(out / "map.yaml"))
    return {
        "outcome": str(result.outcome),
        "reason": result.reason,
        "coverage": result.coverage,
        "enough_s": watch.enough_s,
        "end_s": result.mission_time_s,
        "path_m": watch.path_m,
        "contacts": result.contacts,
        "closest_pair_m": watch.closest_m - 0.5 if case["robots"] > 1 else None,
        "map_error_m": error_m,
        "cpu_ms_per_robot_tick": 1e3 * cpu_s / (watch.ticks * case["robots"]),
    }


def _mission(path: Path, case: dict[str, Any]) -> str:
    robot = (
        f"    driver: {{use: sim2d, world: '{path}', radius: 0.25 m, lidar_range: 5 m}}\n"
        f"    slam: {case['slam']}\n    planner: skeleton\n    controller: pursuit\n"
    )
    options = "".join(
        f", {name}: {value}" for name, _, value in (each.partition("=") for each in case["options"])
    )
    allocator = f"allocator: {{use: {case['allocator']}{options}}}\n" if case["robots"] > 1 else ""
    robots = "".join(f"  r{number:02d}:\n{robot}" for number in range(case["robots"]))
    head = "format: explore-bt/1\nname: fleet\ninclude: [trees/complete.yaml]\n"
    return f"{head}robots:\n{robots}{allocator}limits: {{speed: 0.5 m/s, time: 60 min}}\ntree: complete\n"


def map_error_m(world: World, grid: OccupancyGrid) -> float:
    """Root mean square distance of the map's obstacles from the nearest surface, each at most 0.5 m."""
    centres = grid.centers_of(np.argwhere(grid.occupied))
    away_m = np.array([_from_surface_m(world, x, y) for x, y in centres.tolist()])
    return float(np.sqrt(np.mean(np.minimum(away_m, 0.5) ** 2)))


def _from_surface_m(world: World, x: float, y: float) -> float:
    distance_m, _ = nearest(world.index, x, y, math.inf)
    return float(distance_m)


def _row(found: dict[str, Any], rows: Sequence[dict[str, Any]]) -> str:
    case = found["case"]
    same = ("map", "slam", "seed")
    alone = next(
        (
            each
            for each in rows
            if each["case"]["robots"] == 1 and all(each["case"][key] == case[key] for key in same)
        ),
        None,
    )
    share = ""
    if alone is not None and found["enough_s"] and alone["enough_s"]:
        share = f"{found['enough_s'] / alone['enough_s']:.2f}"
    cells = (
        case["map"],
        case["robots"],
        " ".join((case["allocator"], *case["options"])),
        case["slam"],
        f"{found['outcome']} {100 * (found['coverage'] or 0):.1f} %",
        f"{found['enough_s']:.0f} s" if found["enough_s"] else "never",
        share,
        f"{found['end_s']:.0f} s",
        f"{found['path_m']:.0f} m",
        found["contacts"],
        "" if found["closest_pair_m"] is None else f"{100 * found['closest_pair_m']:.0f} cm",
        f"{100 * found['map_error_m']:.1f} cm",
        f"{found['cpu_ms_per_robot_tick']:.1f} ms",
    )
    return "| " + " | ".join(str(cell) for cell in cells) + " |"


if __name__ == "__main__":
    main()
