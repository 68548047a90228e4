"""How good and how fast is SLAM on recorded logs? One table: kiss-icp alone, kiss-slam, ours.

EXPLORE_BT_DATA=... python benchmarks/slam.py [--logs intel fr079] [--json FILE]

For every log ``carmen/<name>.clf.bz2`` with ``carmen/<name>.relations`` in that folder: error over the
relations (Freiburg metric, mean ± standard deviation) and median milliseconds per scan. The logs are read
before the clock runs. Rows:

- raw odometry: the log's wheels alone.
- kiss-icp, constant velocity: kiss-icp's odometry as it comes, its own guess, lifted to z = 0.
- kiss-icp, odometry guess: the same with the wheels' motion as the guess.
- kiss-slam: kiss-icp with its own loop closures, where it can be imported.
- ours: kiss_gtsam with its default options, from the lidar alone and with ``use_odometry``.
"""

from __future__ import annotations

import argparse
import json
import os
import statistics
import sys
import time
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from dataclasses import asdict, dataclass
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import numpy as np
from explore_bt_drivers import Replay, ReplayOptions
from explore_bt_slam import KissGtsam
from machine import describe_machine
from numpy.typing import NDArray

from explore_bt.evaluation import Relation, read_relations, relation_errors
from explore_bt.interfaces import Recorded, RobotContext
from explore_bt.types import Pose2, Scan2D, Trajectory, WheelOdometry

_KISS_VOXEL_M = 0.1
_KISS_RANGE_M = 5.0
_KISS_SPLIT_M = 10.0
"""Its own default, 100 m between local maps, never ends the first one of an office."""


@dataclass(frozen=True)
class Log:
    """A log in memory: each scan with what the wheels said at it."""

    name: str
    measurements: list[Recorded]
    relations: tuple[Relation, ...]

    @property
    def scans(self) -> list[tuple[float, Scan2D, Pose2]]:
        """Log stamp, scan, odometry."""
        found, wheels = [], Pose2.identity()
        for one in self.measurements:
            if isinstance(one.measurement, WheelOdometry):
                wheels = one.measurement.T_odom_base
            elif isinstance(one.measurement, Scan2D):
                found.append((one.log_stamp_s, one.measurement, wheels))
        return found


@dataclass(frozen=True)
class Row:
    """A line of the table; None where a method cannot run here, ``note`` says why."""

    log: str
    method: str
    figures: dict[str, float] | None
    ms_per_scan: float | None
    note: str = ""


def raw_odometry(log: Log) -> tuple[Trajectory, list[float], str]:
    """What the wheels say."""
    return _trajectory([(stamp_s, wheels) for stamp_s, _, wheels in log.scans]), [], ""


def kiss_icp(log: Log, odometry: bool) -> tuple[Trajectory, list[float], str]:
    """kiss-icp without anything around it."""
    from kiss_icp.config import KISSConfig
    from kiss_icp.kiss_icp import KissICP

    config = KISSConfig()
    config.data.max_range, config.data.min_range, config.data.deskew = _KISS_RANGE_M, 0.1, False
    config.mapping.voxel_size = _KISS_VOXEL_M
    config.adaptive_threshold.initial_threshold, config.adaptive_threshold.min_motion_th = 0.5, 0.05
    odometer, way, taken, before = KissICP(config), [], [], None
    for stamp_s, scan, wheels in log.scans:
        begun_s = time.perf_counter()
        if odometry and before is not None:
            odometer.last_delta = _matrix(before.between(wheels))
        points = _lifted(scan)
        odometer.register_frame(points, np.zeros(len(points)))
        taken.append(time.perf_counter() - begun_s)
        before = wheels
        way.append((stamp_s, _pose(odometer.last_pose)))
    return _trajectory(way), taken, ""


def kiss_slam(log: Log) -> tuple[Trajectory, list[float], str]:
    """kiss-slam, as it comes but for sizes; the wheels cannot tell it anything."""
    from kiss_slam.config import KissSLAMConfig
    from kiss_slam.slam import KissSLAM

    config = KissSLAMConfig()
    config.odometry.preprocessing.max_range, config.odometry.preprocessing.min_range = _KISS_RANGE_M, 0.1
    config.odometry.preprocessing.deskew = False
    config.odometry.mapping.voxel_size = _KISS_VOXEL_M
    config.local_mapper.voxel_size = _KISS_VOXEL_M
    config.local_mapper.splitting_distance = _KISS_SPLIT_M
    slam, taken = KissSLAM(config), []
    for _, scan, _ in log.scans:
        begun_s = time.perf_counter()
        points = _lifted(scan)
        slam.process_scan(points, np.zeros(len(points)))
        taken.append(time.perf_counter() - begun_s)
    slam.generate_new_node()
    way = [(stamp_s, _pose(pose)) for (stamp_s, _, _), pose in zip(log.scans, slam.poses, strict=True)]
    return _trajectory(way), taken, f"{len(slam.get_closures())} closures"


def ours(log: Log, odometry: bool) -> tuple[Trajectory, list[float], str]:
    """kiss_gtsam as a mission has it."""
    slam = KissGtsam(KissGtsam.Options.model_validate({"use_odometry": odometry}))
    slam.setup(RobotContext(limits=ReplayOptions(log=Path()).limits))
    taken, stamps, troubled = [], {}, 0
    for one in log.measurements:
        is_scan = isinstance(one.measurement, Scan2D)
        if not is_scan and not odometry:
            continue
        begun_s = time.perf_counter()
        slam.update(one.measurement)
        if is_scan:
            taken.append(time.perf_counter() - begun_s)
            stamps[one.measurement.stamp_s] = one.log_stamp_s
            troubled += slam.estimate().health == "lost"
    way = slam.trajectory()
    in_log_time = np.array([stamps[stamp_s] for stamp_s in way.stamps_s.tolist()])
    closures = int(slam.figures()["loop_closures"])
    return Trajectory(in_log_time, way.poses), taken, f"{closures} closures, lost at {troubled} scans"


_METHODS: dict[str, Callable[[Log], tuple[Trajectory, list[float], str]]] = {
    "raw odometry": raw_odometry,
    "kiss-icp, constant velocity": lambda log: kiss_icp(log, odometry=False),
    "kiss-icp, odometry guess": lambda log: kiss_icp(log, odometry=True),
    "kiss-slam": kiss_slam,
    "ours, lidar only": lambda log: ours(log, odometry=False),
    "ours, odometry-aided": lambda log: ours(log, odometry=True),
}


def measure(folder: Path, name: str, method: str) -> Row:
    """One method on one log, in a process of its own: foreign code may end it."""
    with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as child:
        try:
            return child.submit(_measure, folder, name, method).result()
        except BrokenProcessPool:
            return Row(name, method, None, None, "failed: it ended its process")
        except Exception as fault:  # a method that fails is a line of the table, not its end
            return Row(name, method, None, None, f"failed: {' '.join(str(fault).split())[:80]}")


def _measure(folder: Path, name: str, method: str) -> Row:
    log = _load(folder, name)
    try:
        way, taken, note = _METHODS[method](log)
    except ImportError as missing:
        return Row(log.name, method, None, None, f"not run: {missing}")
    figures = relation_errors(way, log.relations).as_dict()
    return Row(log.name, method, figures, 1000.0 * statistics.median(taken) if taken else None, note)


def main() -> None:
    """Print one table, and write the same figures as JSON."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--logs", nargs="+", metavar="NAME", help="names in carmen/; else all with relations")
    parser.add_argument("--methods", nargs="+", metavar="NAME", choices=list(_METHODS), help="else all")
    parser.add_argument("--json", type=Path, metavar="FILE", help="where the figures go too")
    asked = parser.parse_args()
    folder = Path(os.environ.get("EXPLORE_BT_DATA", "")) / "carmen"
    names = asked.logs or sorted(path.stem for path in folder.glob("*.relations"))
    if not names:
        sys.exit("no logs: EXPLORE_BT_DATA names the folder that holds carmen/*.clf.bz2 and *.relations")
    machine = describe_machine()
    print(f"Freiburg metric over all relations, mean ± sd; median ms per scan\n{machine}\n")
    print("| log | method | translation, m | rotation, ° | ms per scan | |\n|---|---|---|---|---|---|")
    rows = []
    for name in names:
        for method in asked.methods or _METHODS:
            rows.append(measure(folder, name, method))
            print(_line(rows[-1]), flush=True)
    if asked.json:
        asked.json.write_text(
            json.dumps({"machine": machine, "rows": [asdict(row) for row in rows]}, indent=2) + "\n"
        )


def _load(folder: Path, name: str) -> Log:
    replay = Replay(ReplayOptions(log=folder / f"{name}.clf.bz2"))
    return Log(name, list(replay.recorded()), read_relations(folder / f"{name}.relations"))


def _line(row: Row) -> str:
    if row.figures is None:
        return f"| {row.log} | {row.method} | – | – | – | {row.note} |"
    metres = "{translation_mean_m:.3f} ± {translation_sd_m:.3f}".format(**row.figures)
    degrees = "{rotation_mean_deg:.2f} ± {rotation_sd_deg:.2f}".format(**row.figures)
    taken = "–" if row.ms_per_scan is None else f"{row.ms_per_scan:.1f}"
    return f"| {row.log} | {row.method} | {metres} | {degrees} | {taken} | {row.note} |"


def _lifted(scan: Scan2D) -> NDArray[np.float64]:
    """(N, 3) float64 returns within reach, at height 0."""
    points = scan.points()
    near = points[np.hypot(points[:, 0], points[:, 1]) < _KISS_RANGE_M]
    return np.column_stack((near, np.zeros(len(near))))


def _matrix(pose: Pose2) -> NDArray[np.float64]:
    cos, sin = np.cos(pose.yaw_rad), np.sin(pose.yaw_rad)
    return np.array([[cos, -sin, 0, pose.x], [sin, cos, 0, pose.y], [0, 0, 1, 0], [0, 0, 0, 1.0]])


def _pose(matrix: NDArray[Any]) -> Pose2:
    return Pose2(float(matrix[0, 3]), float(matrix[1, 3]), float(np.arctan2(matrix[1, 0], matrix[0, 0])))


def _trajectory(way: list[tuple[float, Pose2]]) -> Trajectory:
    stamps, poses = zip(*way, strict=True)
    return Trajectory(np.array(stamps), np.array([pose.as_array() for pose in poses]))


if __name__ == "__main__":
    main()
