"""Runs of an exploration benchmark: what is to be done, doing one of it, and remembering what is done."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import dataclass, field, replace
from functools import lru_cache
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from exploration_stage import CanvasDrawer, Stage, set_stage
from numpy.typing import NDArray

from explore_bt.evaluation import (
    Decider,
    KnownFloor,
    PlainNearestFrontier,
    Trial,
    TrialRobot,
    TrialSettings,
    lookouts_of,
    run_trial,
    set_cover_tour_m,
)
from explore_bt.evaluation import watchman_tours as find_tours
from explore_bt.files import write_whole
from explore_bt.types import Pose2

__all__ = ["BUDGET", "PLAIN", "SHARES", "Store", "Task", "in_parallel", "over_ray", "run_task"]

PLAIN = "plain_nearest"
SHARES = (0.9, 0.95, 0.99)
_SEARCHED = tuple(
    sorted((*SHARES, *(share + 0.005 for share in SHARES)))
)  # scans see a little less than ideal
_MISSION_01_S = 180.0  # the paper's real run
_METRES_PER_M2, _METRES_MORE = 1.5, 50.0
BUDGET = f"{_METRES_MORE:g} m and {_METRES_PER_M2:g} m for every m² to be seen"


@dataclass(frozen=True, slots=True)
class Task:
    """One run, or one tour if ``strategy`` is empty; ``key`` names it in the file of results."""

    strategy: str
    map: str
    start: int
    starts: int
    seed: int
    settings: TrialSettings = field(default_factory=TrialSettings)
    rounds: int = 60

    @property
    def key(self) -> str:
        """The same for the same run."""
        return f"{self.strategy or 'tour'} {Path(self.map).stem} {self.start} {self.seed}"


class Store:
    """Rows and tours in one JSON file, curves beside it; whole after every run, so it can be killed."""

    def __init__(self, file: Path, about: dict[str, Any]) -> None:
        """Reads what is there.

        Raises:
            ValueError: the file is of runs with other settings.
        """
        self._file = file
        self._curves = file.with_suffix(".curves")
        self._curves.mkdir(parents=True, exist_ok=True)
        self._content: dict[str, Any] = {"settings": about["settings"], "runs": [], "rows": {}, "tours": {}}
        if file.exists():
            self._content = json.loads(file.read_text())
        if self._content["settings"] != about["settings"]:
            raise ValueError(
                f"{file} holds runs with {self._content['settings']}, asked for are {about['settings']}; "
                "name another file"
            )
        self._content["runs"].append(about["machine"])

    @property
    def rows(self) -> list[dict[str, Any]]:
        """One a run, with ratios where the tour is known; in the order of their keys."""
        return [self._with_ratios(row) for _, row in sorted(self._content["rows"].items())]

    def has(self, task: Task) -> bool:
        """Whether the task is done."""
        return task.key in self._content["rows" if task.strategy else "tours"]

    def add(self, task: Task, row: dict[str, Any]) -> dict[str, Any]:
        """Take in what a task gave; the row with its ratios."""
        curve = row.pop("curve", None)
        if curve is not None:
            np.savez_compressed(self._curves / f"{task.key.replace(' ', '_').replace('/', '_')}.npz", **curve)
        self._content["rows" if task.strategy else "tours"][task.key] = row
        rows = {**self._content, "table": self.rows}
        write_whole(self._file, json.dumps(rows, indent=1))
        return self._with_ratios(row) if task.strategy else row

    def curve(self, row: dict[str, Any]) -> dict[str, np.ndarray]:
        """Metres, seconds, coverage and track of a run."""
        name = f"{row['strategy']} {row['map']} {row['start']} {row['seed']}"
        with np.load(self._curves / f"{name.replace(' ', '_').replace('/', '_')}.npz") as arrays:
            return {key: arrays[key] for key in arrays}

    def _with_ratios(self, row: dict[str, Any]) -> dict[str, Any]:
        tour = self._content["tours"].get(f"tour {row['map']} {row['start']} {row['seed']}")
        if tour is None or "path_to_m" not in row:
            return row
        ratios = {
            f"{name}_{100 * share:.0f}": _ratio(row["path_to_m"][f"{share:g}"], tour[bound][f"{share:g}"])
            for name, bound in (("ratio", "length_m"), ("set_cover_ratio", "set_cover_m"))
            for share in SHARES
        }
        bounds = {"tour_m": tour["length_m"], "clearance_bound_m": tour["clearance_bound_m"]}
        return {**row, **ratios, **bounds}


def _ratio(path_m: float | None, tour_m: float | None) -> float | None:
    return None if path_m is None or not tour_m else round(path_m / tour_m, 4)


def run_task(task: Task) -> dict[str, Any]:
    """Do it, in this process; an explorer that raises gives a row that says so."""
    cv2.setNumThreads(1)
    stage = _stage(task.map, task.settings.radius_m, task.settings.range_m, task.starts, task.seed)
    if not task.strategy:
        return _tour(stage, task)
    area_m2 = float(stage.floor.free.sum()) * stage.floor.resolution_m**2
    budget_m = _METRES_MORE + _METRES_PER_M2 * area_m2
    settings = replace(task.settings, most_path_m=budget_m)
    drawer = CanvasDrawer(settings.radius_m, settings.range_m)
    row = {"strategy": task.strategy, "map": stage.name, "start": task.start, "seed": task.seed}
    try:
        decider = _decider(task.strategy, settings)
        trial = run_trial(decider, stage.world, drawer, stage.floor, stage.starts[task.start], settings)
    except Exception as fault:  # the benchmark goes on: one strategy's fault is its own row
        return {**row, "outcome": f"failed: {type(fault).__name__}: {fault}"}
    return {**row, **_figures(trial), "area_m2": round(area_m2, 1)}


@lru_cache(maxsize=2)
def _stage(path: str, radius_m: float, range_m: float, count: int, seed: int) -> Stage:
    return set_stage(Path(path), radius_m, range_m, count, seed)


def _decider(strategy: str, settings: TrialSettings) -> Decider:
    if strategy == PLAIN:
        return PlainNearestFrontier(settings.radius_m)
    from explore_bt import Explorer  # only here: the baseline needs none

    name, _, weight = strategy.partition("@")
    taste = {"safety_weight": float(weight)} if weight else {}
    return Explorer(name, robot_radius_m=settings.radius_m, lidar_range_m=settings.range_m, **taste)


def _tour(stage: Stage, task: Task) -> dict[str, Any]:
    floor, start = stage.world.floor, stage.starts[task.start]
    known = KnownFloor(floor.free, stage.floor.free, stage.reachable, floor.resolution_m)
    tours = find_tours(
        known, floor.cell_of(*start.xy), task.settings.range_m, _SEARCHED, rounds=task.rounds, seed=task.seed
    )
    lookouts = lookouts_of(known, floor.cell_of(*start.xy), task.settings.range_m)
    curves = [_driven(stage, start, floor.centers_of(tour.corners), task.settings) for tour in tours]
    return {
        "length_m": {
            f"{share:g}": _finite(min(_reached(curve, share) for curve in curves)) for share in SHARES
        },
        "set_cover_m": {f"{share:g}": _finite(set_cover_tour_m(lookouts, share)) for share in SHARES},
        "clearance_bound_m": round(stage.clearance_bound_m, 3),
        "corners_m": floor.centers_of(tours[-1].corners).round(3).tolist(),
    }


def _driven(
    stage: Stage, start: Pose2, way: NDArray[np.float64], settings: TrialSettings
) -> NDArray[np.float64]:
    """The curve of a robot that drives the tour: the same lidar, map and measure as in every run."""
    drawer = CanvasDrawer(settings.radius_m, settings.range_m)
    slim = replace(settings, radius_m=0.0)  # lines between cells may pass a corner a centimetre too near
    robot = TrialRobot(stage.world, drawer, stage.floor, start, slim)
    corners = [(float(x), float(y)) for x, y in way]
    while corners and robot.drive(corners, settings.step_m):
        pass
    return robot.curve


def _reached(curve: NDArray[np.float64], share: float) -> float:
    there = curve[:, 2] >= share
    return float(curve[int(np.argmax(there)), 0]) if there.any() else math.inf


def _figures(trial: Trial) -> dict[str, Any]:
    decision_ms = 1e3 * trial.decision_s
    return {
        "outcome": trial.outcome,
        "finished": trial.outcome not in ("over_budget", "stuck"),
        "reason": trial.reason,
        "coverage": round(trial.coverage, 5),
        "path_m": round(trial.path_m, 3),
        "path_to_m": {f"{share:g}": _finite(trial.path_to_m(share)) for share in SHARES},
        "time_s": round(trial.time_s, 2),
        "time_to_s": {f"{share:g}": _finite(trial.time_to_s(share)) for share in SHARES},
        "coverage_at_180_s": round(trial.coverage_at_s(_MISSION_01_S), 5),
        "mean_clearance_m": round(trial.mean_clearance_m, 4),
        "min_clearance_m": round(trial.min_clearance_m, 4),
        "contacts": trial.contacts,
        "turning_rad": round(trial.turning_rad, 2),
        "goal_changes_per_100m": round(100.0 * trial.goal_changes / max(trial.path_m, 1.0), 2),
        "goals_dropped_per_100m": round(100.0 * trial.goals_dropped / max(trial.path_m, 1.0), 2),
        "decisions": len(decision_ms),
        "decision_ms_median": round(float(np.median(decision_ms)), 2),
        "decision_ms_p99": round(float(np.percentile(decision_ms, 99)), 2),
        "curve": {"curve": trial.curve.astype(np.float32), "track": trial.track.astype(np.float32)},
    }


def _finite(value: float) -> float | None:
    """JSON knows no infinity."""
    return round(value, 3) if math.isfinite(value) else None


def in_parallel(tasks: Sequence[Task], jobs: int) -> Iterator[tuple[Task, dict[str, Any]]]:
    """Each task with what it gave, as they end, over the cores of this machine."""
    if jobs == 1:
        yield from ((task, run_task(task)) for task in tasks)
        return
    with ProcessPoolExecutor(jobs, mp_context=get_context("spawn")) as pool:
        futures = {pool.submit(run_task, task): task for task in tasks}
        for future in as_completed(futures):
            yield futures[future], future.result()


def over_ray(tasks: Sequence[Task], address: str) -> Iterator[tuple[Task, dict[str, Any]]]:
    """The same over a Ray cluster whose machines have explore-bt and these scripts at the same place.

    Raises:
        ImportError: Ray is not installed.
    """
    try:
        import ray
    except ModuleNotFoundError as error:
        raise ImportError('--ray needs Ray: pip install "explore-bt[ray]"') from error
    here = str(Path(__file__).parent)
    ray.init(address=None if address == "local" else address, runtime_env={"env_vars": {"PYTHONPATH": here}})
    remote: Callable[[Task], Any] = ray.remote(run_task).remote
    waiting = {remote(task): task for task in tasks}
    while waiting:
        done, _ = ray.wait(list(waiting))
        for reference in done:
            yield waiting.pop(reference), ray.get(reference)
