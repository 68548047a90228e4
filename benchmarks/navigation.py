"""Is the planner one to switch on?  python benchmarks/navigation.py [--map MAP.yaml] [--json FILE]

Map and skeleton: full, updated in a window, queried, in CPU milliseconds; cells that differ from a full
recompute over random windows. Planners from the package index on the same pairs: time, length, clearance. The
widest passage against a slow independent search. Without --map a made-up building is used.

Control: paths driven by each controller behind the gate, error, limits, CPU time of a cycle. People: errands
in known flats and a corridor among walkers who heed nobody.
"""

from __future__ import annotations

import argparse
import json
import time
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from building import make_building
from explore_bt_planners import Skeleton
from explore_bt_planners.feature_transform import feature_transform
from explore_bt_planners.terrain import Terrain
from explore_bt_planners.terrain_cache import TerrainCache
from machine import describe_machine
from navigation_control import control_part
from navigation_people import people_part
from numpy.typing import NDArray
from planner_peers import PEERS, PIP_LINE, Cell
from scipy.ndimage import label
from scipy.spatial import cKDTree

from explore_bt.errors import GoalBlocked, NoPath, StartBlocked
from explore_bt.exploration.clearance import clearance_field
from explore_bt.maps import read_map
from explore_bt.testing.planner_contract import points_along
from explore_bt.types import FREE, OCCUPIED, UNKNOWN, GridWindow, OccupancyGrid, Pose2

RADIUS_M, MARGIN_M, SEPARATION = 0.25, 0.02, 1.7
WINDOW_M = 10.0
TASTES: dict[str, dict[str, float]] = {
    "skeleton": {},
    "roomy": {"comfortable": 2.5, "clearance_weight": 30.0},
    "roomiest": {"comfortable": 1.8, "clearance_weight": 300.0},
}
INTERPOLATION_M = 0.002  # between cell centres, a bilinear clearance is above the exact one by less
FIELDS = ("clearance_m", "passable", "skeleton")


def cpu_ms(work: Callable[[], object]) -> float:
    """Process CPU milliseconds of one call."""
    begin = time.process_time()
    work()
    return 1000.0 * (time.process_time() - begin)


def derive(grid: OccupancyGrid) -> Terrain:
    """All that a query needs, from nothing."""
    terrain = Terrain(
        grid, RADIUS_M + MARGIN_M, SEPARATION, feature_transform(np.ascontiguousarray(grid.cells))
    )
    for field in FIELDS:
        getattr(terrain, field)
    return terrain


def redraw(grid: OccupancyGrid, truth: OccupancyGrid, rng: np.random.Generator) -> tuple[Any, GridWindow]:
    """The next revision: in a random window the truth is seen, forgotten, sprinkled, or a box is moved."""
    size = min(round(WINDOW_M / grid.resolution_m), *grid.shape)
    row, col = (int(rng.integers(0, length - size + 1)) for length in grid.shape)
    window = GridWindow(row, col, row + size, col + size)
    cells = grid.cells.copy()
    part, kind = cells[window.slices], rng.integers(4)
    if kind == 1:
        part[rng.random(part.shape) < 0.5 * rng.random()] = UNKNOWN
    else:
        part[:] = truth.cells[window.slices]
    if kind == 2:
        part[rng.random(part.shape) < 0.01] = OCCUPIED
    if kind == 3:
        r, c = rng.integers(0, size, size=2)
        part[r : r + 20, c : c + 20] = rng.choice([FREE, OCCUPIED, UNKNOWN])
    return replace(grid, cells=cells, revision=grid.revision + 1), window


def differing_cells(kept: Terrain, fresh: Terrain) -> int:
    """Cells in which any field of two terrains differs."""
    pairs = [(getattr(kept, name), getattr(fresh, name)) for name in FIELDS]
    pairs += [(getattr(kept.transform, n), getattr(fresh.transform, n)) for n in ("squared", "row", "col")]
    return int(np.logical_or.reduce([one != other for one, other in pairs]).sum())


def bit_equality(truth: OccupancyGrid, windows: int, rng: np.random.Generator) -> dict[str, float]:
    """Cells that differ from a full recompute after each of many windows, summed up."""
    terrains, grid, differ = TerrainCache(SEPARATION), truth, 0
    for _ in range(windows):
        after, window = redraw(grid, truth, rng)
        terrains.expect(grid, after, window)
        grid = after
        kept = terrains.terrain(grid, RADIUS_M + MARGIN_M)
        for field in FIELDS:
            getattr(kept, field)
        differ += differing_cells(kept, derive(grid))
    return {"windows": windows, "cells_that_differ": differ, "full_recomputes": terrains.lineage - 1}


def update_times(truth: OccupancyGrid, count: int, rng: np.random.Generator) -> dict[str, float]:
    """Of the transform and all fields, the window being known, or the whole map being compared."""
    spent: dict[bool, list[float]] = {True: [], False: []}
    terrains, grid = TerrainCache(SEPARATION), truth
    for number in range(2 * count):
        kept = terrains.terrain(grid, RADIUS_M + MARGIN_M)
        for field in FIELDS:
            getattr(kept, field)
        after, window = redraw(grid, truth, rng)
        known = number % 2 == 0
        if known:
            terrains.expect(grid, after, window)
        grid = after
        spent[known].append(cpu_ms(lambda now=grid: terrains.terrain(now, RADIUS_M + MARGIN_M)))
    for rows in (1, 2):  # the first compiles
        terrains.terrain(replace(truth, cells=np.pad(truth.cells, ((0, rows), (0, 0)))), RADIUS_M + MARGIN_M)
    terrains.terrain(grid, RADIUS_M + MARGIN_M)
    for field in FIELDS:
        getattr(terrains.terrain(grid, RADIUS_M + MARGIN_M), field)
    grown = replace(grid, cells=np.pad(grid.cells, ((0, 100), (0, 0)), constant_values=UNKNOWN))
    return {
        "update_ms": float(np.median(spent[True])),
        "update_p95_ms": float(np.percentile(spent[True], 95)),
        "update_with_comparison_ms": float(np.median(spent[False])),
        "growth_by_5_m_ms": cpu_ms(lambda: terrains.terrain(grown, RADIUS_M + MARGIN_M)),
    }


def pairs_in(grid: OccupancyGrid, count: int, rng: np.random.Generator) -> list[tuple[Cell, Cell]]:
    """Random starts and goals where the footprint fits, in the largest piece of such floor."""
    pieces, _ = label(clearance_field(grid) >= RADIUS_M + MARGIN_M)
    places = np.argwhere(pieces == 1 + np.bincount(pieces[pieces > 0] - 1).argmax())
    ends = places[rng.integers(len(places), size=(count, 2))].tolist()
    return [((a[0], a[1]), (b[0], b[1])) for a, b in ends]


def query_times(grid: OccupancyGrid, count: int, rng: np.random.Generator) -> dict[str, float]:
    """Plans on a map that is ready."""
    planner, spent, lengths = Skeleton(Skeleton.Options()), [], []
    for start, goal in pairs_in(grid, count + 1, rng):
        begin = time.process_time()
        path = planner.plan(grid, at(grid, start), at(grid, goal), RADIUS_M)
        spent.append(1000.0 * (time.process_time() - begin))
        lengths.append(path.length_m)
    return {
        "query_ms": float(np.median(spent[1:])),
        "query_p95_ms": float(np.percentile(spent[1:], 95)),
        "length_median_m": float(np.median(lengths)),
    }


def at(grid: OccupancyGrid, cell: Cell) -> Pose2:
    """The pose in the middle of a cell."""
    return Pose2(*grid.center_of(*cell), 0.0)


def clearances(
    grid: OccupancyGrid, field: NDArray[np.float32], xy: NDArray[np.float64]
) -> NDArray[np.float32]:
    """Of the cells along a polyline in metres, at every centimetre."""
    steps = np.hypot(*np.diff(xy, axis=0).T)
    along = np.concatenate(([0.0], np.cumsum(steps)))
    wanted = np.linspace(0.0, along[-1], max(2, int(along[-1] / 0.01)))
    points = np.column_stack([np.interp(wanted, along, axis) for axis in xy.T])
    cells = grid.cells_of(points)
    return field[cells[:, 0], cells[:, 1]]


def judge(
    grid: OccupancyGrid, field: NDArray[np.float32], xy: NDArray[np.float64]
) -> tuple[float, float, float]:
    """Length, lowest and mean clearance of a polyline, metres."""
    found = clearances(grid, field, xy)
    return float(np.hypot(*np.diff(xy, axis=0).T).sum()), float(found.min()), float(found.mean())


def drive(grid: OccupancyGrid, pairs: list[tuple[Cell, Cell]], taste: str) -> NDArray[np.float64]:
    """(N, 4) float64: CPU milliseconds, length, lowest and mean clearance of our path for every pair."""
    field, planner, rows = clearance_field(grid), Skeleton(Skeleton.Options(**TASTES[taste])), []
    planner.plan(grid, at(grid, pairs[0][0]), at(grid, pairs[0][1]), RADIUS_M)
    for start, goal in pairs:
        begin = time.process_time()
        path = planner.plan(grid, at(grid, start), at(grid, goal), RADIUS_M)
        rows.append((1000.0 * (time.process_time() - begin), *judge(grid, field, path.poses[:, :2])))
    return np.array(rows)


def compare(grid: OccupancyGrid, pairs: list[tuple[Cell, Cell]], budget_s: float) -> dict[str, Any]:
    """Ours on all pairs, every peer on as many of them as its budget allows."""
    field = clearance_field(grid)
    ours = {taste: drive(grid, pairs, taste) for taste in TASTES}
    result: dict[str, Any] = {
        taste: {
            "pairs": len(pairs),
            "ms": float(np.median(table[:, 0])),
            "paths_below_r": int((table[:, 2] < RADIUS_M).sum()),
            "min_clearance_m": float(table[:, 2].min()),
            "mean_clearance_m": float(table[:, 3].mean()),
        }
        for taste, table in ours.items()
    }
    for name, make in PEERS.items():
        try:
            result[name] = against(ours, grid, field, make(field >= RADIUS_M), pairs, budget_s)
        except ImportError:
            result[name] = {"missing": PIP_LINE}
        print(peer_row(name, result[name]), flush=True)
    return result


def against(
    ours: dict[str, NDArray[np.float64]],
    grid: OccupancyGrid,
    field: NDArray[np.float32],
    plan: Callable[[Cell, Cell], NDArray[np.float64] | None],
    pairs: list[tuple[Cell, Cell]],
    budget_s: float,
) -> dict[str, Any]:
    """One peer's figures over the pairs both of us joined and that are a metre apart."""
    theirs, which, failed, begun = [], [], 0, time.process_time()
    for k, (start, goal) in enumerate(pairs):
        if time.process_time() - begun > budget_s:
            break
        begin = time.process_time()
        route = plan(start, goal)
        spent = 1000.0 * (time.process_time() - begin)
        if route is None:
            failed += 1
        elif ours["skeleton"][k, 1] > 1.0:
            xy = (route[:, ::-1] + 0.5) * grid.resolution_m + np.asarray(grid.origin_xy)
            theirs.append((spent, *judge(grid, field, xy)))
            which.append(k)
    them = np.array(theirs)
    figures: dict[str, Any] = {
        "pairs": len(them),
        "failed": failed,
        "ms": float(np.median(them[:, 0])),
        "time_ratio": float(np.median(them[:, 0] / ours["skeleton"][which, 0])),
        "min_clearance_m": float(them[:, 2].min()),
        "mean_clearance_m": float(them[:, 3].mean()),
        "paths_below_r": int((them[:, 2] < RADIUS_M).sum()),
    }
    for taste, table in ours.items():
        us = table[which]
        figures[taste] = {
            "length_ratio": float((us[:, 1] / them[:, 1]).mean()),
            "longest_ratio": float((us[:, 1] / them[:, 1]).max()),
            "clearance_ratio": float(us[:, 3].mean() / them[:, 3].mean()),
        }
    return figures


def widest_passages(grid: OccupancyGrid, pairs: list[tuple[Cell, Cell]]) -> dict[str, float]:
    """Paths whose exact clearance is what bisection over all widths of cells says is possible."""
    field, planner = clearance_field(grid), Skeleton(Skeleton.Options(widest=True))
    levels = np.unique(field[field > 0])
    obstacles = cKDTree(grid.centers_of(np.argwhere(np.pad(grid.cells != FREE, 1, constant_values=True)) - 1))

    @cache
    def pieces(k: int) -> NDArray[np.int32]:
        return np.asarray(label(field >= levels[k])[0], dtype=np.int32)

    attained, spent = 0, []
    for start, goal in pairs:
        low, high = -1, len(levels)
        while high - low > 1:
            middle = (low + high) // 2
            joined = pieces(middle)[start] > 0 and pieces(middle)[start] == pieces(middle)[goal]
            low, high = (middle, high) if joined else (low, middle)
        begin = time.process_time()
        try:
            path = planner.plan(grid, at(grid, start), at(grid, goal), RADIUS_M)
        except (NoPath, StartBlocked, GoalBlocked):
            continue
        spent.append(1000.0 * (time.process_time() - begin))
        points, _ = points_along(path, 0.01)
        lowest = obstacles.query(points)[0].min() - 0.5 * grid.resolution_m
        attained += bool(lowest >= levels[low] - INTERPOLATION_M)
    return {"pairs": len(pairs), "attained": attained, "ms": float(np.median(spent))}


def peer_row(name: str, figures: dict[str, Any]) -> str:
    """One line of the table of peers."""
    if "missing" in figures:
        return f"| {name} | not installed: `{figures['missing']}` ||||||||||"
    ratios = [
        f"{figures[taste]['length_ratio']:.2f} (≤ {figures[taste]['longest_ratio']:.2f}) | "
        f"{figures[taste]['clearance_ratio']:.2f}"
        for taste in TASTES
    ]
    return (
        f"| {name} | {figures['pairs']} | {figures['ms']:.2f} ms | {figures['time_ratio']:.1f} × | "
        f"{' | '.join(ratios)} | {figures['min_clearance_m']:.2f} m | {figures['paths_below_r']} |"
    )


def planner_part(arguments: argparse.Namespace) -> dict[str, Any]:
    """The planner's half; prints its tables and returns their figures."""
    rng = np.random.default_rng(arguments.seed)
    named = read_map(Path(arguments.map)) if arguments.map else None
    grids = {f"{n} × {n}": make_building(n) for n in (400, 1000, 4000)}
    if named is not None:
        grids = {Path(arguments.map).stem: named, **grids}
    print("| map | full | update (95 %) | comparing all | growth | query (95 %) | median way |")
    print("|---|---|---|---|---|---|---|")
    figures: dict[str, Any] = {"maps": {}}
    for name, grid in grids.items():
        derive(grid)
        count = 15 if max(grid.shape) <= 1000 else 5
        full = float(np.median([cpu_ms(lambda it=grid: derive(it)) for _ in range(count)]))
        row = {"full_ms": full, **update_times(grid, 4 * count, rng), **query_times(grid, 8 * count, rng)}
        figures["maps"][name] = row
        print(
            f"| {name} | {full:.1f} ms | {row['update_ms']:.2f} ms ({row['update_p95_ms']:.2f}) | "
            f"{row['update_with_comparison_ms']:.2f} ms | {row['growth_by_5_m_ms']:.1f} ms | "
            f"{row['query_ms']:.2f} ms ({row['query_p95_ms']:.2f}) | {row['length_median_m']:.1f} m |",
            flush=True,
        )
    arena = next(iter(grids.values()))
    figures["bit_equality"] = bit_equality(arena, arguments.windows, rng)
    print("\n{windows} random windows: {cells_that_differ} cells differ".format(**figures["bit_equality"]))
    pairs = pairs_in(arena, arguments.pairs, rng)
    print("\n| peer | pairs | its time | to ours | length | clearance | roomy: length | clearance | ", end="")
    print("roomiest: length | clearance | its least | below r |")
    print("|---|---|---|---|---|---|---|---|---|---|---|---|")
    figures["peers"] = compare(arena, pairs, arguments.peer_seconds)
    print()
    for taste in TASTES:
        print(
            "{0}: {pairs} pairs, {ms:.2f} ms, least clearance {min_clearance_m:.3f} m, mean "
            "{mean_clearance_m:.2f} m, {paths_below_r} paths below r".format(taste, **figures["peers"][taste])
        )
    figures["widest"] = widest_passages(arena, pairs)
    print("widest passage: attained in {attained} of {pairs} pairs, {ms:.1f} ms".format(**figures["widest"]))
    return figures


PARTS: dict[str, Callable[[argparse.Namespace], dict[str, Any]]] = {
    "planner": planner_part,
    "control": control_part,
    "people": people_part,
}


def main() -> None:
    """Run every part."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--map", metavar="MAP.yaml", help="plan on this map instead of the made-up building")
    parser.add_argument("--json", metavar="FILE", help="write all figures here")
    parser.add_argument("--pairs", type=int, default=500)
    parser.add_argument("--windows", type=int, default=1000)
    parser.add_argument("--peer-seconds", type=float, default=30.0, help="CPU time for each peer")
    parser.add_argument("--paths", type=int, default=50, help="driven by each controller")
    parser.add_argument("--episodes", type=int, default=50, help="errands among people, by each controller")
    parser.add_argument("--walkers", type=int, default=4)
    parser.add_argument("--jobs", type=int, default=2, help="errands at a time")
    parser.add_argument("--parts", default=",".join(PARTS), help="which of: %(default)s")
    parser.add_argument("--seed", type=int, default=0)
    arguments = parser.parse_args()
    chosen = arguments.parts.split(",")
    if unknown := [name for name in chosen if name not in PARTS]:
        parser.error(f"--parts: there is no part {unknown[0]}; choose from {', '.join(PARTS)}")
    machine = describe_machine()
    print(f"navigation, {machine}\n")
    figures: dict[str, Any] = {"machine": machine}
    for name in chosen:
        figures[name] = PARTS[name](arguments)
        print()
    if arguments.json:
        Path(arguments.json).write_text(json.dumps(figures, indent=2) + "\n")


if __name__ == "__main__":
    main()
