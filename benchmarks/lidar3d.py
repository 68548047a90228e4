"""How well does kiss_gtsam do with a 16 × 900 lidar at 10 Hz on a spinning, pitching body in the flat?

python benchmarks/lidar3d.py [--hours H] [--seed S] [--plot FILE.png] [OPTION=VALUE ...]

Range 5 m with 2 cm noise, IMU at 250 Hz, turns at 1.5 rad/s, pitch ±9°, roll ±2°. Without --hours one tour
through all rooms; with it, tours until that much time has passed, memory noted after each; Ctrl-C makes the
tour under way the last. Times are CPU time of the process, for the cloud and the IMU samples before it: a
shared machine does not count.
"""

from __future__ import annotations

import argparse
import math
import signal
import time
from dataclasses import dataclass, field
from itertools import chain
from pathlib import Path
from threading import Event

import numpy as np
from explore_bt_drivers.world import World, load_world
from explore_bt_slam import KissGtsam
from flat3d import APARTMENT, flat, tour
from machine import describe_machine
from matplotlib.figure import Figure

from explore_bt.interfaces import RobotContext
from explore_bt.testing.balancing_robot import BalancingRobot
from explore_bt.testing.scene3 import Prism
from explore_bt.types import Health, OccupancyGrid, PointCloud, Pose2

_START = Pose2(3.3, 3.6, 0.0)
_BODY_M = 0.2
_PHANTOM_M = 0.1


@dataclass
class Notes:
    """What is written down on the way; memory rows are hours, MB of the process, MB of voxels, keyframes."""

    truth: dict[float, Pose2] = field(default_factory=dict)
    milliseconds: list[float] = field(default_factory=list)
    unwell: int = 0
    memory: list[tuple[float, float, float, float]] = field(default_factory=list)


def resident_mb() -> float:
    """Memory of this process."""
    lines = Path("/proc/self/status").read_text().splitlines()
    return next(float(line.split()[1]) / 1024.0 for line in lines if line.startswith("VmRSS"))


def run(slam: KissGtsam, robot: BalancingRobot, hours: float) -> Notes:
    """Stand a second, then tours."""
    notes, spent, enough = Notes(), 0.0, Event()
    signal.signal(signal.SIGINT, lambda *_: enough.set())
    while not notes.memory or (robot.time_s < 3600.0 * hours and not enough.is_set()):
        for measurement in chain(robot.drive(0.0, 0.0, 1.0), tour(robot)):
            begun = time.process_time()
            slam.update(measurement)
            spent += time.process_time() - begun
            if isinstance(measurement, PointCloud):
                notes.milliseconds.append(1000.0 * spent)
                notes.truth[measurement.stamp_s] = robot.pose
                notes.unwell += slam.estimate().health is not Health.OK
                spent = 0.0
        figures = slam.figures()
        row = (robot.time_s / 3600.0, resident_mb(), figures["voxel_mb"], figures["keyframes"])
        notes.memory.append(row)
    return notes


def phantoms(grid: OccupancyGrid, world: World, prisms: tuple[Prism, ...]) -> int:
    """Occupied cells farther than 10 cm from any solid and from any table top."""
    tops = [prism.corners for prism in prisms if prism.low_m > 0.0]
    boxes = [(top.min(axis=0) - _PHANTOM_M, top.max(axis=0) + _PHANTOM_M) for top in tops]
    return sum(
        world.clearance_m(*place) > _PHANTOM_M
        and not any((low <= place).all() and (place <= high).all() for low, high in boxes)
        for place in grid.centers_of(np.argwhere(grid.occupied))
    )


def report(slam: KissGtsam, robot: BalancingRobot, notes: Notes) -> None:
    """Print everything."""
    trajectory, grid, world = slam.trajectory(), slam.grid(), load_world(APARTMENT)
    truth = np.array([notes.truth[stamp_s].as_array() for stamp_s in trajectory.stamps_s.tolist()])
    off = np.hypot(*(trajectory.poses - truth)[:, :2].T)
    median, p99 = np.percentile(notes.milliseconds, [50, 99])
    floor = world.floor.centers_of(np.argwhere(world.floor.free))
    states = np.array([grid.value_at(*place) for place in floor])
    figures = slam.figures()
    rows = {
        "driven, turned": f"{robot.driven_m:.0f} m, {robot.turned_rad:.0f} rad in {robot.time_s:.0f} s",
        "scans, not ok": f"{len(notes.milliseconds)}, {notes.unwell}",
        "ATE, not aligned": f"rmse {100 * np.sqrt(np.mean(off**2)):.1f} cm, worst {100 * off.max():.1f} cm",
        "CPU per scan, median, p99, worst": f"{median:.1f}, {p99:.1f}, {max(notes.milliseconds):.0f} ms",
        "keyframes, closures": f"{figures['keyframes']:.0f}, {figures['loop_closures']:.0f}",
        "phantom cells": f"{phantoms(grid, world, robot.scene.prisms)} of {np.count_nonzero(grid.occupied)}",
        "true floor: free, unknown": f"{np.mean(states == 0):.1%}, {np.mean(states == -1):.1%}",
    }
    print("| | |\n|---|---|")
    for name, value in rows.items():
        print(f"| {name} | {value} |")
    print("\n| hours | process | voxels | keyframes |\n|---|---|---|---|")
    shown = sorted({0, *np.linspace(0, len(notes.memory) - 1, 8).astype(int).tolist()})
    for hours, process_mb, voxel_mb, keyframes in (notes.memory[k] for k in shown):
        print(f"| {hours:.2f} | {process_mb:.0f} MB | {voxel_mb:.1f} MB | {keyframes:.0f} |")


def plot(notes: Notes, path: Path) -> None:
    """Memory over time."""
    figure = Figure(figsize=(6.0, 3.0), layout="constrained")
    axes = figure.subplots()
    table = np.array(notes.memory)
    axes.plot(table[:, 0], table[:, 1])
    axes.set(
        xlabel="simulated hours",
        ylabel="process, MB",
        ylim=(0.0, 1.2 * table[:, 1].max()),
        title="memory over time",
    )
    figure.savefig(path, dpi=120)


def main() -> None:
    """One course, one report."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--hours", type=float, default=0.0, help="simulated; 0 is one tour of 145 s")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--plot", type=Path, help="PNG of memory over time")
    parser.add_argument("options", nargs="*", metavar="OPTION=VALUE", help="of kiss_gtsam")
    arguments = parser.parse_args()
    options = dict(pair.split("=", 1) for pair in arguments.options)
    swing = {"pitch_rad": math.radians(9.0), "roll_rad": math.radians(2.0)}
    robot = BalancingRobot(flat(), _START, seed=arguments.seed, **swing)
    slam = KissGtsam(KissGtsam.Options.model_validate(options))
    slam.setup(RobotContext(start=robot.pose, footprint_radius_m=_BODY_M))
    print(
        f"{Path(__file__).name}: {APARTMENT.stem}, seed {arguments.seed}; {describe_machine()}\n", flush=True
    )
    notes = run(slam, robot, arguments.hours)
    report(slam, robot, notes)
    if arguments.plot:
        plot(notes, arguments.plot)


if __name__ == "__main__":
    main()
