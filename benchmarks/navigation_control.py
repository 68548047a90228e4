"""Paths driven in the simulator by each controller behind the gate: error, limits kept, time a cycle."""

from __future__ import annotations

import argparse
import time
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from explore_bt_controllers import Mppi, Pursuit
from explore_bt_drivers import Sim2d
from explore_bt_drivers.world import load_world
from explore_bt_planners import Skeleton
from numpy.typing import NDArray

from explore_bt.exploration import clearance_field
from explore_bt.interfaces import Controller, ControlStatus, RobotContext, Surroundings
from explore_bt.runtime.pilot import Pilot
from explore_bt.runtime.safety_gate import SafetyGate
from explore_bt.runtime.steadied import steadied
from explore_bt.types import Estimate, MotionLimits, OccupancyGrid, Pose2, Scan2D
from explore_bt.types import Path as Way

__all__ = ["control_part"]

CONTROLLERS: tuple[type[Controller], ...] = (Pursuit, Mppi)
RADIUS_M, MARGIN_M = 0.25, 0.02
DT_S = 0.05
_LEAST_M, _MOST_M = 4.0, 20.0
_SLOWEST_MPS = 0.1
"""A drive is given up if it takes as long as at this mean speed."""
_HOME = Path(__file__).resolve().parent.parent / "missions/worlds/apartment.yaml"


@dataclass(slots=True)
class _Drive:
    """One path: the true places, the commands sent, CPU milliseconds of every cycle."""

    arrived: bool = False
    places: list[tuple[float, float]] = field(default_factory=list)
    commands: list[tuple[float, float]] = field(default_factory=list)
    cycles_ms: list[float] = field(default_factory=list)
    contacts: int = 0


def control_part(arguments: argparse.Namespace) -> dict[str, Any]:
    """The controllers' half; prints its table and returns its figures."""
    world = Path(arguments.map) if arguments.map else _HOME
    floor = load_world(world).floor
    paths = _paths(floor, arguments.paths, np.random.default_rng(arguments.seed))
    print(f"{len(paths)} paths of {_LEAST_M:g} to {_MOST_M:g} m on {world.stem}, 0.5 m/s, exact poses")
    print(
        "| controller | arrived | largest error, mean (worst) | acceleration, jerk of their limits ", end=""
    )
    print("| contacts | cycle with gate, median | p99 |\n|---|---|---|---|---|---|---|")
    figures = {}
    for kind in CONTROLLERS:
        drives = [_drive(kind, world, floor, path) for path in paths]
        figures[kind.name] = row = _figures(drives, paths)
        print(
            f"| {kind.name} | {row['arrived']} of {row['paths']} | "
            f"{100 * row['largest_error_mean_m']:.1f} cm ({100 * row['largest_error_worst_m']:.1f}) | "
            f"{row['acceleration_share']:.3f}, {row['jerk_share']:.3f} | {row['contacts']} | "
            f"{row['cycle_ms_median']:.2f} ms | {row['cycle_ms_p99']:.2f} ms |",
            flush=True,
        )
    return figures


def _paths(floor: OccupancyGrid, count: int, rng: np.random.Generator) -> list[Way]:
    """Smoothed paths of the planner between random places in one piece of floor."""
    planner = Skeleton(Skeleton.Options())
    places = floor.centers_of(np.argwhere(clearance_field(floor) >= RADIUS_M + MARGIN_M))
    found: list[Way] = []
    while len(found) < count:
        start, goal = places[rng.integers(len(places), size=2)]
        try:
            path = planner.plan(floor, Pose2(*start.tolist(), 0.0), Pose2(*goal.tolist(), 0.0), RADIUS_M)
        except Exception:  # pieces of floor that are not joined: draw again
            continue
        if _LEAST_M <= path.length_m <= _MOST_M:
            found.append(path)
    return found


def _drive(kind: type[Controller], world: Path, floor: OccupancyGrid, path: Way) -> _Drive:
    driver = Sim2d(Sim2d.Options(world=world, radius=RADIUS_M, noise=False))
    begin = Pose2(*path.poses[0].tolist())
    driver.setup(RobotContext(start=begin))
    truth, limits = driver.truth(), driver.limits
    assert truth is not None
    controller = kind(kind.Options())
    controller.setup(RobotContext(footprint_radius_m=RADIUS_M, limits=limits))
    pilot = Pilot(controller, SafetyGate(RADIUS_M, limits), driver, limits)
    drive, scan, estimate = _Drive(), None, Estimate(0.0, begin)
    pilot.follow(path)
    until_s = path.length_m / _SLOWEST_MPS + 10.0
    while driver.clock.now_s() < until_s:
        now_s = driver.clock.now_s()
        for measured in driver.read():
            if isinstance(measured, Scan2D):
                scan, estimate = measured, Estimate(measured.stamp_s, truth.pose())
                points = estimate.T_map_base.apply(steadied(scan).points())
                pilot.see(Surroundings(scan.stamp_s, points, floor), estimate)
        begun = time.process_time()
        pilot.step(estimate, scan, now_s, DT_S)
        drive.cycles_ms.append(1000.0 * (time.process_time() - begun))
        twist = pilot.motion.twist
        drive.commands.append((twist.linear_mps, twist.angular_rps))
        drive.places.append(truth.pose().xy)
        if pilot.output.status is ControlStatus.ARRIVED:
            drive.arrived = True
            break
        driver.clock.wait_until(now_s + DT_S)
    drive.contacts = truth.contacts()
    driver.close()
    return drive


def _figures(drives: list[_Drive], paths: list[Way]) -> dict[str, Any]:
    errors = [_largest_error_m(np.array(d.places), path) for d, path in zip(drives, paths, strict=True)]
    shares = np.array([_limit_shares(np.array(drive.commands)) for drive in drives])
    cycles = np.concatenate([drive.cycles_ms[5:] for drive in drives])
    return {
        "paths": len(drives),
        "arrived": sum(drive.arrived for drive in drives),
        "largest_error_mean_m": float(np.mean(errors)),
        "largest_error_worst_m": float(np.max(errors)),
        "acceleration_share": float(shares[:, 0].max()),
        "jerk_share": float(shares[:, 1].max()),
        "contacts": sum(drive.contacts for drive in drives),
        "cycle_ms_median": float(np.median(cycles)),
        "cycle_ms_p99": float(np.percentile(cycles, 99)),
    }


def _largest_error_m(places: NDArray[np.float64], path: Way) -> float:
    """From the true places to the path's broken line."""
    begin, along = path.poses[:-1, :2], np.diff(path.poses[:, :2], axis=0)
    square = np.maximum(np.einsum("ij,ij->i", along, along), 1e-12)
    off = places[:, None] - begin
    share = np.clip(np.einsum("ijk,jk->ij", off, along) / square, 0.0, 1.0)
    apart = np.linalg.norm(off - share[..., None] * along, axis=2)
    return float(apart.min(axis=1).max())


def _limit_shares(commands: NDArray[np.float64]) -> tuple[float, float]:
    """The largest acceleration and jerk of both axes, each as a share of its limit."""
    limits = MotionLimits()
    acceleration = np.diff(commands, axis=0, prepend=0.0) / DT_S
    jerk = np.diff(acceleration, axis=0, prepend=0.0) / DT_S
    most = (limits.acceleration_mps2, limits.turn_acceleration_rps2)
    hardest = (limits.jerk_mps3, limits.turn_jerk_rps3)
    return float((np.abs(acceleration) / most).max()), float((np.abs(jerk) / hardest).max())
