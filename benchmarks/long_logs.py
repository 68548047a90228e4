"""Is any place lost, never closed or wrongly closed on a long log?  python benchmarks/long_logs.py.

Drives robots of the CARMEN years (180° view, few scans a second, wheels that turn by some degrees in 10 m)
through building maps from EXPLORE_BT_DATA and two rings of long corridors, writes CARMEN logs, and maps those
as ``explore-bt slam LOG [--odometry]`` does. The truth is known, so every closure can be judged.

Columns: how far the wheels' end is off; scans at which health was ``lost``; closures, and how many of them
are off by more than 0.3 m or 0.1 rad; worst error of the live pose while driving; error over relations
between scans 1 to 10 s apart (near) and between scans within 5 m of one another but at least a minute apart
(again), mean and worst; CPU time a scan.
"""

from __future__ import annotations

import argparse
import math
import os
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from explore_bt_drivers import Replay, ReplayOptions
from explore_bt_drivers.world import load_world
from explore_bt_slam import KissGtsam
from long_courses import LONG_CORRIDORS, LoggingRobot, corridors_map, drive, tour, write_log
from machine import describe_machine
from numpy.typing import NDArray

from explore_bt.interfaces import RobotContext
from explore_bt.types import Pose2, PoseGraph2, Scan2D, Trajectory

_HEADER = (
    "| course | wheels | driven m | wheels off m | scans | lost | closures | false | live worst m "
    "| near m (mean, worst) | again m (mean, worst) | again ° | ms median, p99 |\n" + "|---" * 13 + "|"
)
_FALSE_M, _FALSE_RAD = 0.3, 0.1


@dataclass(frozen=True, slots=True)
class Course:
    """A map, how many random places are visited, and the robot."""

    map: str
    places: int
    robot: LoggingRobot


_COURSES = {
    "corridors": Course("", 0, LoggingRobot(speed_mps=0.6)),
    "corridors, 2 Hz": Course(
        "", 0, LoggingRobot(speed_mps=0.6, rate_hz=2.0, beams=181, jitter_s=0.05, is_robotlaser=True)
    ),
    "corridors, 8 m": Course("", 0, LoggingRobot(speed_mps=0.6, range_m=8.18, beams=361)),
    "willow": Course("ros/willow_garage_full", 18, LoggingRobot(range_m=80.0)),
    "kth floor": Course("kth/50010535_PLAN1", 12, LoggingRobot(speed_mps=0.6, wheel_turn_degpm=0.5)),
    "kth floor, 2 Hz": Course(
        "kth/50010535_PLAN1", 12, LoggingRobot(rate_hz=2.0, beams=361, is_robotlaser=True)
    ),
    "intel": Course("sdgrm/intel_lab", 20, LoggingRobot(range_m=8.18, wheel_turn_degpm=0.5)),
}


def make(name: str, folder: Path, seed: int) -> tuple[Path, NDArray[np.float64], NDArray[np.float64]]:
    """Write a course's log; its path, the scans' stamps (N,) and true poses (N, 3)."""
    course = _COURSES[name]
    if course.map:
        world = load_world(Path(os.environ["EXPLORE_BT_DATA"]) / "floorplans" / f"{course.map}.yaml")
        places = tour(world, course.places, seed)
    else:
        world, places = load_world(corridors_map(folder, seed)), LONG_CORRIDORS
    path = folder / f"{name.replace(' ', '_').replace(',', '')}.clf.bz2"
    stamps, truth = write_log(path, world, drive(world, places, course.robot), course.robot, seed)
    relations = [*_pairs(truth, stamps, is_near=True), *_pairs(truth, stamps, is_near=False)]
    path.with_name(path.name.replace(".clf.bz2", ".relations")).write_text(
        "".join(
            f"{stamps[a]:.6f} {stamps[b]:.6f} {step.x:.6f} {step.y:.6f} 0 0 0 {step.yaw_rad:.6f}\n"
            for a, b in relations
            for step in [_pose(truth[a]).between(_pose(truth[b]))]
        )
    )
    return path, stamps, truth


def measure(
    name: str, log: Path, stamps: NDArray[np.float64], truth: NDArray[np.float64], odometry: bool
) -> str:
    """One row of the table."""
    replay = Replay(ReplayOptions(log=log))
    slam = KissGtsam(KissGtsam.Options.model_validate({"use_odometry": odometry}))
    slam.setup(RobotContext(limits=ReplayOptions(log=log).limits))
    taken, lost, worst, scan, wheels = [], 0, 0.0, 0, Pose2.identity()
    for one in replay.recorded():
        if not isinstance(one.measurement, Scan2D):
            wheels = one.measurement.T_odom_base
            if odometry:
                slam.update(one.measurement)
            continue
        begin = time.process_time()
        slam.update(one.measurement)
        taken.append(time.process_time() - begin)
        estimate = slam.estimate()
        lost += estimate.health == "lost"
        worst = max(worst, estimate.T_map_base.distance_to(_pose(truth[0]).between(_pose(truth[scan]))))
        scan += 1
    way, graph = slam.trajectory(), slam.structure().graph
    assert graph is not None
    closures, false = _judged(graph, way, truth)
    near = _errors(way, truth, _pairs(truth, stamps, is_near=True))
    again = _errors(way, truth, _pairs(truth, stamps, is_near=False))
    driven = float(np.hypot(*np.diff(truth[:, :2], axis=0).T).sum())
    off = wheels.distance_to(_pose(truth[0]).between(_pose(truth[-1])))
    ms = 1000.0 * np.percentile(taken, [50, 99])
    return (
        f"| {name} | {'yes' if odometry else 'no'} | {driven:.0f} | {off:.0f} | {scan} | {lost} | {closures} "
        f"| {false} | {worst:.1f} | {near[:, 0].mean():.3f}, {near[:, 0].max():.2f} "
        f"| {again[:, 0].mean():.3f}, {again[:, 0].max():.2f} | {np.degrees(again[:, 1].mean()):.2f} "
        f"| {ms[0]:.1f}, {ms[1]:.0f} |"
    )


def main() -> None:
    """Print one table."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--courses", nargs="+", metavar="NAME", choices=list(_COURSES), help="else all")
    parser.add_argument("--wheels", choices=["yes", "no"], help="else both")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--keep", type=Path, metavar="DIR", help="where logs and relations stay")
    asked = parser.parse_args()
    if "EXPLORE_BT_DATA" not in os.environ:
        sys.exit("EXPLORE_BT_DATA is not set: it names the folder that holds floorplans/")
    print(f"seed {asked.seed}; {describe_machine()}\n\n{_HEADER}", flush=True)
    with tempfile.TemporaryDirectory() as scratch:
        folder = asked.keep or Path(scratch)
        folder.mkdir(parents=True, exist_ok=True)
        for name in asked.courses or _COURSES:
            log, stamps, truth = make(name, folder, asked.seed)
            for wheels in [asked.wheels] if asked.wheels else ["yes", "no"]:
                print(measure(name, log, stamps, truth, wheels == "yes"), flush=True)


def _pairs(truth: NDArray[np.float64], stamps: NDArray[np.float64], is_near: bool) -> list[tuple[int, int]]:
    """About 2,000 pairs of scans: a few seconds apart, or at the same place after at least a minute."""
    rng = np.random.default_rng(1)
    first = rng.integers(len(truth), size=20_000)
    if is_near:
        last = first[:2000] + rng.integers(1, 50, size=2000)
        pairs = [(a, b) for a, b in zip(first.tolist(), last.tolist(), strict=False) if b < len(truth)]
        return [(a, b) for a, b in pairs if 1.0 <= stamps[b] - stamps[a] <= 10.0]
    pairs = list(zip(first.tolist(), rng.integers(len(truth), size=20_000).tolist(), strict=True))
    return [
        (a, b)
        for a, b in pairs
        if stamps[b] - stamps[a] > 60.0 and math.hypot(*(truth[a] - truth[b])[:2]) < 5.0
    ]


def _errors(way: Trajectory, truth: NDArray[np.float64], pairs: list[tuple[int, int]]) -> NDArray[np.float64]:
    """(N, 2): metres and radians that each pair is off."""
    found = []
    for a, b in pairs:
        believed = _pose(way.poses[a]).between(_pose(way.poses[b]))
        off = _pose(truth[a]).between(_pose(truth[b])).between(believed)
        found.append((math.hypot(off.x, off.y), abs(off.yaw_rad)))
    return np.array(found).reshape(-1, 2)


def _judged(graph: PoseGraph2, way: Trajectory, truth: NDArray[np.float64]) -> tuple[int, int]:
    """How many closures there are, and how many of them are false."""
    scans: list[int] = []
    for scan, pose in enumerate(way.poses):
        if len(scans) < len(graph.poses) and np.allclose(pose[:2], graph.poses[len(scans), :2], atol=1e-9):
            scans.append(scan)
    closures = false = 0
    for (a, b), relative in zip(graph.ends.tolist(), graph.relatives, strict=True):
        if abs(a - b) == 1:
            continue
        closures += 1
        off = _pose(truth[scans[a]]).between(_pose(truth[scans[b]])).between(_pose(relative))
        false += math.hypot(off.x, off.y) > _FALSE_M or abs(off.yaw_rad) > _FALSE_RAD
    return closures, false


def _pose(row: NDArray[np.float64]) -> Pose2:
    return Pose2(*row.tolist())


if __name__ == "__main__":
    main()
