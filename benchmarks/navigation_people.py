"""Errands among people who heed nobody: who arrives, how late, and who was run into."""

from __future__ import annotations

import argparse
import math
import statistics
import tempfile
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict, dataclass, replace
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import numpy as np
from explore_bt_drivers.world import load_world

from explore_bt.evaluation import spread_starts
from explore_bt.mission import load_mission
from explore_bt.plugin import load_plugins
from explore_bt.runtime import StopFlag, run_mission
from explore_bt.types import Outcome, Pose2, Result
from explore_bt.worlds import generate_world

__all__ = ["people_part"]

MISSIONS = Path(__file__).resolve().parent.parent / "missions"
CONTROLLERS = ("pursuit", "mppi")
LATE = 3.0
"""An errand may take so many times as long as alone."""
_RADIUS_M = 0.25
_SPARE_M = 0.1
_FAR_M, _NEAR_M = 5.0, 25.0
_ARRIVED_M = 0.3
CORRIDOR = """\
format: explore-bt-world/1
name: corridor
start: [1.0, 0.8, 0 deg]
rooms:
  - {name: corridor, box: [0, 0, 16, 1.7]}
  - {name: room 1, box: [1, 1.7, 5, 5]}
  - {name: room 2, box: [5, 1.7, 10, 5]}
  - {name: room 3, box: [10, 1.7, 15, 5]}
  - {name: room 4, box: [6, -3.5, 11, 0]}
doors:
  - {at: [3, 1.7], width: 0.9}
  - {at: [7.5, 1.7], width: 0.9}
  - {at: [12.5, 1.7], width: 0.9}
  - {at: [9, 0], width: 0.9}
"""


@dataclass(frozen=True, slots=True)
class Errand:
    """One episode: from where to where, in which world, with whom."""

    world: Path
    known: Path
    start: Pose2
    goal: Pose2
    seed: int
    walkers: int
    controller: str


@dataclass(frozen=True, slots=True)
class Outing:
    """How it went; contacts are those at more than 0.05 m/s, touches those at rest."""

    arrived: bool
    time_s: float
    contacts: int
    touches: int
    reason: str


def people_part(arguments: argparse.Namespace) -> dict[str, Any]:
    """The part about people; prints its table and returns its figures."""
    print("| controller | episodes | arrived in 3 × the time alone | contacts while moving ", end="")
    print("| touched at rest | time to time alone, median |\n|---|---|---|---|---|---|")
    figures: dict[str, Any] = {}
    with tempfile.TemporaryDirectory() as folder:
        worlds = [_mapped(world, Path(folder)) for world in _worlds(Path(folder))]
        with ProcessPoolExecutor(arguments.jobs, mp_context=get_context("spawn")) as pool:
            for controller in CONTROLLERS:
                errands = list(_errands(worlds, arguments.episodes, arguments.walkers, controller))
                alone = pool.map(run_errand, [replace(errand, walkers=0) for errand in errands])
                among = pool.map(run_errand, errands)
                figures[controller] = _figures(errands, list(alone), list(among))
                print(_row(controller, figures[controller]), flush=True)
    return figures


def _worlds(folder: Path) -> Iterator[Path]:
    """Flats and a corridor with rooms, none of them a map that exploration is judged on."""
    yield MISSIONS / "worlds/apartment.yaml"
    corridor = folder / "corridor.yaml"
    corridor.write_text(CORRIDOR)
    yield corridor
    for seed in (11, 12):
        flat = folder / f"flat{seed}.yaml"
        flat.write_text(generate_world("apartment", seed))
        yield flat


def _mapped(world: Path, folder: Path) -> tuple[Path, Path]:
    """The world, and what SLAM knows of it after exploring it alone."""
    out = folder / f"{world.stem}-known"
    _run("02_any_map.yaml", [f"world={world}", "slam=ground_truth"], 0, out)
    return world, out / "slam"


def _errands(
    worlds: Sequence[tuple[Path, Path]], count: int, walkers: int, controller: str
) -> Iterator[Errand]:
    for episode in range(count):
        world, known = worlds[episode % len(worlds)]
        floor = load_world(world).floor
        start, *places = spread_starts(floor, _RADIUS_M + _SPARE_M, 12, seed=episode)
        goal = places[int(np.random.default_rng(episode).integers(len(places)))]
        yield Errand(world, known, start, goal, episode, walkers, controller)


def run_errand(errand: Errand) -> Outing:
    """Drive it."""
    start, goal = errand.start, errand.goal
    settings = [
        f"world={errand.world}",
        f"map={errand.known}",
        f"start=[{start.x:.3f}, {start.y:.3f}, {start.yaw_rad:.3f}]",
        f"x={goal.x:.3f}",
        f"y={goal.y:.3f}",
        f"walkers={errand.walkers}",
        f"controller={errand.controller}",
        "slam=ground_truth",
    ]
    with tempfile.TemporaryDirectory() as out:
        result = _run("03_errand.yaml", settings, errand.seed, Path(out))
    return Outing(
        result.outcome is Outcome.EXPLORED,
        result.mission_time_s,
        result.contacts or 0,
        result.touched_by_people or 0,
        result.reason,
    )


def _run(name: str, settings: Sequence[str], seed: int, out: Path) -> Result:
    registry = load_plugins().registry
    mission = load_mission(MISSIONS / name, registry, list(settings))
    return run_mission(mission, registry=registry, out=out, seed=seed, sinks=(), stop=StopFlag())


def _figures(errands: Sequence[Errand], alone: Sequence[Outing], among: Sequence[Outing]) -> dict[str, Any]:
    ratios = [
        with_people.time_s / by_itself.time_s if with_people.arrived else math.inf
        for by_itself, with_people in zip(alone, among, strict=True)
    ]
    return {
        "episodes": len(errands),
        "arrived_alone": sum(outing.arrived for outing in alone),
        "arrived_in_time": sum(ratio <= LATE for ratio in ratios),
        "contacts_while_moving": sum(outing.contacts for outing in among),
        "touched_at_rest": sum(outing.touches for outing in among),
        "time_ratio_median": statistics.median(ratios),
        "runs": [
            {"world": errand.world.stem, "seed": errand.seed, "alone_s": lonely.time_s, **asdict(outing)}
            for errand, lonely, outing in zip(errands, alone, among, strict=True)
        ],
    }


def _row(controller: str, figures: dict[str, Any]) -> str:
    return (
        f"| {controller} | {figures['episodes']} | {figures['arrived_in_time']} | "
        f"{figures['contacts_while_moving']} | {figures['touched_at_rest']} | "
        f"{figures['time_ratio_median']:.2f} |"
    )
