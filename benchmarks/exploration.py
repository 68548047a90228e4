"""Which strategy explores best?  python benchmarks/exploration.py --strategies complete,paper --json FILE.

Every strategy on every map from the same starts, with true poses and a lidar without noise, against the
offline tour that knows the map (see explore_bt/evaluation/offline_tour.py). Maps are named by a pattern below
the folder ``floorplans`` under EXPLORE_BT_DATA, or by files of their own. The file of results is whole after
every run: kill the benchmark and start it again, it goes on.
"""

from __future__ import annotations

import argparse
import glob
import itertools
import os
import sys
from dataclasses import asdict
from pathlib import Path

from exploration_runs import BUDGET, PLAIN, Store, Task, in_parallel, over_ray
from exploration_table import per_map, per_strategy, write_plots
from machine import describe_machine

from explore_bt.evaluation import TrialSettings


def main() -> None:
    """Run what is missing, and print the table."""
    asked = _arguments().parse_args()
    settings = TrialSettings(
        radius_m=asked.radius, range_m=asked.range, beams=asked.beams, decide_every_m=asked.decide_every
    )
    maps = _maps(asked.maps)
    machine = describe_machine()
    about = {"starts": asked.starts, "rounds": asked.rounds, **asdict(settings), "most_path_m": BUDGET}
    try:
        store = Store(asked.json, {"machine": machine, "settings": about})
    except ValueError as error:
        sys.exit(str(error))
    print(f"{machine}; {len(maps)} maps, {asked.starts} starts, {about}", flush=True)
    places = list(itertools.product(maps, range(asked.starts), range(asked.seeds)))
    strategies = [name for name in asked.strategies.split(",") if name]
    for names in ([""], strategies):  # tours first: every run is then measured against its own at once
        tasks = [
            Task(name, str(path), start, asked.starts, seed, settings, asked.rounds)
            for path, start, seed in places
            for name in names
        ]
        missing = [task for task in tasks if not store.has(task)]
        try:
            done = over_ray(missing, asked.ray) if asked.ray else in_parallel(missing, asked.jobs)
            for count, (task, row) in enumerate(done, start=1):
                shown = store.add(task, row)
                print(f"{count}/{len(missing)} {task.key}: {_brief(shown)}", flush=True)
        except ImportError as error:
            sys.exit(str(error))
        except KeyboardInterrupt:
            sys.exit(f"stopped; what is done is in {asked.json}, the same command goes on")
    mine = {path.stem for path in maps}
    rows = [row for row in store.rows if row["strategy"] in strategies and row["map"] in mine]
    print(f"\n{per_map(rows)}\n\n{per_strategy(rows)}\n")
    for file in write_plots(store, asked.json.with_suffix("")):
        print(file)


def _arguments() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--maps", default="*/*.yaml", metavar="GLOB", help="below floorplans/, or of files")
    parser.add_argument(
        "--strategies",
        default=f"complete,{PLAIN}",
        metavar="A,B",
        help=f"or {PLAIN}; NAME@W: with safety weight W",
    )
    parser.add_argument("--starts", type=int, default=4, metavar="N", help="on each map")
    parser.add_argument("--seeds", type=int, default=1, metavar="N", help="each with starts of its own")
    parser.add_argument(
        "--json", type=Path, required=True, metavar="FILE", help="results; goes on from there"
    )
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1, metavar="N", help="processes")
    parser.add_argument("--ray", nargs="?", const="local", metavar="ADDRESS", help="over a Ray cluster")
    parser.add_argument("--radius", type=float, default=0.2, metavar="M", help="of the robot")
    parser.add_argument("--range", type=float, default=5.0, metavar="M", help="of the lidar")
    parser.add_argument("--beams", type=int, default=360, metavar="N", help="of the lidar, all round")
    parser.add_argument("--decide-every", type=float, default=0.5, metavar="M", help="ask again then")
    parser.add_argument("--rounds", type=int, default=60, metavar="N", help="of the search for the tours")
    return parser


def _maps(pattern: str) -> list[Path]:
    """Maps below the data folder, else files as named."""
    data = os.environ.get("EXPLORE_BT_DATA")
    found = sorted((Path(data) / "floorplans").glob(pattern)) if data and not pattern.startswith("/") else []
    found = found or [Path(name) for name in sorted(glob.glob(pattern))]
    if not found:
        where = f"below {data}/floorplans or " if data else "(EXPLORE_BT_DATA is not set) "
        sys.exit(f"--maps {pattern}: no map {where}among files; give a pattern such as 'kth/*.yaml'")
    return found


def _brief(row: dict[str, object]) -> str:
    keys = ("outcome", "coverage", "path_m", "ratio_90", "ratio_95", "ratio_99", "contacts", "length_m")
    return ", ".join(f"{key} {row[key]}" for key in keys if key in row)


if __name__ == "__main__":
    main()
