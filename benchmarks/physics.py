"""How fast is the physical robot, what takes the time, and does it explore the flat?

python benchmarks/physics.py [--seeds 5] [--camera 320x240] [--json FILE]

Times are process CPU times. (The file is not called after MuJoCo: it would be imported in its place.)
"""

from __future__ import annotations

import argparse
import functools
import json
import multiprocessing
import tempfile
import time
from collections import defaultdict
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from machine import ROOT, describe_machine

MISSION = ROOT / "missions/04_mujoco_flat.yaml"
APARTMENT = ROOT / "missions/worlds/apartment.yaml"
_ALONE_S = 30.0
_CAMERAS = ("off", "320x240", "640x480")


class Stopwatch:
    """CPU seconds by part; what a part calls of another part counts for that one."""

    def __init__(self) -> None:
        self.spent_s: defaultdict[str, float] = defaultdict(float)
        self._stack: list[str] = []
        self._since_s = time.process_time()

    @contextmanager
    def part(self, name: str) -> Iterator[None]:
        """All that is done inside counts for a part."""
        self._switch()
        self._stack.append(name)
        try:
            yield
        finally:
            self._switch()
            self._stack.pop()

    def watch(self, owner: Any, method: str, name: str) -> None:
        """Count a method of a class for a part."""
        inner: Callable[..., Any] = getattr(owner, method)

        @functools.wraps(inner)
        def timed(*args: Any, **kwargs: Any) -> Any:
            with self.part(name):
                return inner(*args, **kwargs)

        setattr(owner, method, timed)

    def _switch(self) -> None:
        now_s = time.process_time()
        if self._stack:
            self.spent_s[self._stack[-1]] += now_s - self._since_s
        self._since_s = now_s


def alone(camera: str) -> dict[str, Any]:
    """The driver by itself, turning and driving to and fro in the living room."""
    from explore_bt_drivers.mujoco import Mujoco
    from explore_bt_drivers.mujoco.body import Body
    from explore_bt_drivers.mujoco.camera import RgbdCamera
    from explore_bt_drivers.mujoco.lidar import VelodyneLike

    from explore_bt.interfaces import RobotContext
    from explore_bt.types import Twist2

    watch = Stopwatch()
    watch.watch(Body, "advance", "physics and balance")
    watch.watch(VelodyneLike, "measure", "lidar")
    watch.watch(RgbdCamera, "measure", "camera")
    driver = Mujoco(Mujoco.Options.model_validate({"world": APARTMENT, "camera": camera}))
    begin_s = time.process_time()
    driver.setup(RobotContext(seed=0))
    ready_s = time.process_time() - begin_s
    watch.spent_s.clear()
    begin_s = time.process_time()
    with watch.part("everything else"):
        for period in range(round(_ALONE_S / 0.05)):
            ahead = 0.2 if period % 160 < 80 else -0.2
            driver.command(Twist2(ahead, 0.8))
            driver.clock.wait_until(0.05 * (period + 1))
            driver.read()
    spent_s = time.process_time() - begin_s
    driver.close()
    shares = {name: value / spent_s for name, value in watch.spent_s.items()}
    return {"camera": camera, "setup_s": ready_s, "real_time_factor": _ALONE_S / spent_s, "shares": shares}


def explore(seed: int, camera: str, folder: Path) -> dict[str, Any]:
    """The whole mission in this process, with everything that a user gets."""
    from explore_bt_drivers.mujoco import Mujoco

    from explore_bt.cli.sinks import make_sinks
    from explore_bt.mission import load_mission
    from explore_bt.plugin import load_plugins
    from explore_bt.runtime import StopFlag, run_mission
    from explore_bt.runtime.robot import Robot

    watch, falls = _watched_mission(), []
    close = Mujoco.close

    def counted(driver: Mujoco) -> None:
        if driver._simulation is not None:
            falls.append(driver._simulation.body.falls)
        close(driver)

    Mujoco.close = counted  # type: ignore[method-assign]  # read off what the driver knows at its end
    registry = load_plugins().registry
    mission = load_mission(MISSION, registry, [f"camera={camera}"])
    sinks = make_sinks(registry, ["mcap", "report"])
    setup = Robot.setup

    def from_here(robot: Robot, *args: Any) -> None:
        setup(robot, *args)
        watch.spent_s.clear()

    Robot.setup = from_here  # type: ignore[method-assign]  # compiling is not part of the run
    with watch.part("everything else"):
        result = run_mission(mission, registry=registry, out=folder, seed=seed, sinks=sinks, stop=StopFlag())
    spent_s = sum(watch.spent_s.values())
    return {
        "seed": seed,
        "camera": camera,
        "outcome": str(result.outcome),
        "coverage": result.coverage,
        "falls": max(falls, default=None),
        "contacts": result.contacts,
        "ate_rmse_m": result.ate_rmse_m,
        "min_clearance_m": result.min_clearance_m,
        "home_m": result.distance_to_home_m,
        "path_m": result.path_length_m,
        "mission_s": result.mission_time_s,
        "real_time_factor": result.mission_time_s / spent_s,
        "shares": {name: value / spent_s for name, value in watch.spent_s.items()},
        "closures": result.slam.get("loop_closures"),
    }


def _watched_mission() -> Stopwatch:
    """Counts what each part of a mission takes."""
    from explore_bt_drivers.mujoco.simulation import Simulation
    from explore_bt_slam import KissGtsam

    from explore_bt.runtime.lookout import Lookout
    from explore_bt.runtime.observers import Observers
    from explore_bt.runtime.robot import Robot

    watch = Stopwatch()
    watch.watch(Simulation, "wait_until", "driver")
    watch.watch(KissGtsam, "update", "SLAM")
    watch.watch(Lookout, "hear", "lookout of the gate")
    watch.watch(Robot, "decide", "tree and planner")
    watch.watch(Robot, "act", "control and gate")
    watch.watch(Observers, "tick", "recording")
    return watch


def main() -> None:
    """Print the tables; each row in a process of its own."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=5, help="seeds 0 to N-1; 0: the driver alone")
    parser.add_argument("--camera", choices=_CAMERAS, default="320x240", help="of the missions")
    parser.add_argument("--missions-only", action="store_true", help="leave the driver alone out")
    parser.add_argument("--json", type=Path, help="write all figures to a file too")
    arguments = parser.parse_args()
    print(f"driver mujoco in {APARTMENT.name}, {describe_machine()}\n")
    with multiprocessing.get_context("spawn").Pool(1, maxtasksperchild=1) as pool:
        cameras = () if arguments.missions_only else _CAMERAS
        drivers = [pool.apply(alone, (camera,)) for camera in cameras]
        print("| camera | set-up | real time × | shares |\n|---|---|---|---|")
        for found in drivers:
            print(
                f"| {found['camera']} | {found['setup_s']:.1f} s | {found['real_time_factor']:.1f} "
                f"| {_shares(found)} |"
            )
        print(f"\n{MISSION.name}, camera {arguments.camera}\n\n{_HEADER}", flush=True)
        runs = []
        with tempfile.TemporaryDirectory() as folder:
            for seed in range(arguments.seeds):
                runs.append(pool.apply(explore, (seed, arguments.camera, Path(folder) / str(seed))))
                print(_row(runs[-1]), flush=True)
    if arguments.json:
        arguments.json.write_text(json.dumps({"alone": drivers, "missions": runs}, indent=1))


_HEADER = (
    "| seed | outcome | mapped | falls | contacts | ATE | closest | home | path | time "
    "| real time × | shares |\n"
    "|---|---|---|---|---|---|---|---|---|---|---|---|"
)


def _row(run: dict[str, Any]) -> str:
    cells = (
        f"{run['seed']}",
        run["outcome"],
        f"{100 * run['coverage']:.1f} %",
        f"{run['falls']}",
        f"{run['contacts']}",
        f"{100 * run['ate_rmse_m']:.1f} cm",
        f"{run['min_clearance_m']:.2f} m",
        f"{100 * run['home_m']:.0f} cm",
        f"{run['path_m']:.0f} m",
        f"{run['mission_s']:.0f} s",
        f"{run['real_time_factor']:.1f}",
        _shares(run),
    )
    return f"| {' | '.join(cells)} |"


def _shares(found: dict[str, Any]) -> str:
    ranked = sorted(found["shares"].items(), key=lambda item: -item[1])
    return ", ".join(f"{name} {100 * share:.0f} %" for name, share in ranked)


if __name__ == "__main__":
    main()
