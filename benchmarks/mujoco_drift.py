"""Does the camera help where the lidar drifts?  python benchmarks/mujoco_drift.py [--seeds 3] [--json FILE].

Eleven minutes round a ring of corridors, 30 % of the lidar's turn covered, camera closures off and on: both
get the same measurements of the ``mujoco`` driver's lidar, camera and IMU. The body is led along its course,
leaning as it speeds up and swaying as a balancing robot does, so that it drives the same whatever SLAM says.
"""

from __future__ import annotations

import argparse
import itertools
import json
import math
import tempfile
import time
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
from explore_bt_drivers.mujoco.body.build import WHEEL_RADIUS_M
from explore_bt_drivers.mujoco.camera import RgbdCamera
from explore_bt_drivers.mujoco.imu import InertialUnit
from explore_bt_drivers.mujoco.lidar import VelodyneLike
from explore_bt_drivers.mujoco.options import MujocoOptions
from explore_bt_drivers.mujoco.scene import Surroundings, build_scene
from explore_bt_drivers.mujoco.track import STEP_S, Track
from explore_bt_drivers.people import Town
from explore_bt_drivers.world import load_world
from explore_bt_slam import KissGtsam
from machine import describe_machine
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from explore_bt.interfaces import RobotContext
from explore_bt.types import Measurement, Pose2

Floats = NDArray[np.float64]

_LONG_M, _SHORT_M, _WIDE_M = 34.0, 12.0, 1.8
_COURSES = ("plain", "furnished")
_LAPS = 3.2
_SPEED_MPS, _TURN_RPS, _ACCELERATION_MPS2, _TURN_RPS2 = 0.5, 1.0, 0.5, 2.0
_LEAN_S, _SWAY_RAD, _SWAY_HZ = 0.3, math.radians(1.2), 0.7
_STEPS_AT_ONCE = 50
_G_MPS2 = 9.81
_CABINETS = (
    *((2.3, 0.9), (6.8, 1.4), (10.1, 0.6), (14.6, 1.1)),
    *((19.0, 0.8), (22.2, 1.6), (26.9, 0.7), (31.0, 1.2)),
)
"""Where along a side, and how wide, metres."""
_BLOCKED = 0.3
"""Share of the lidar's turn."""


def ring(course: str) -> str:
    """A corridor about a core, with cabinets along it, in ``plain`` but for a stretch of 16 m."""
    half = _WIDE_M / 2.0
    outer = (-half, -half, _LONG_M + half, _SHORT_M + half)
    inner = (half, half, _LONG_M - half, _SHORT_M - half)
    lines = [
        "format: explore-bt-world/1",
        "rooms:",
        f"  - {{name: ring, box: {list(outer)}}}",
        f"  - {{name: core, box: {list(inner)}}}",
        "furniture:",
    ]
    boxes = [
        (x, -half + 0.05, x + wide, -half + 0.35)
        for x, wide in _CABINETS
        if course == "furnished" or not 9.0 < x < 25.0
    ]
    far = _SHORT_M + half
    boxes += [(_LONG_M - x - wide, far - 0.4, _LONG_M - x, far - 0.05) for x, wide in _CABINETS]
    boxes += [(-half + 0.05, 4.0, -half + 0.35, 5.0), (_LONG_M + half - 0.4, 3.0, _LONG_M + half - 0.05, 3.8)]
    boxes += [(_LONG_M - half - 0.3, 7.0, _LONG_M - half - 0.05, 8.2), (half + 0.05, 7.5, half + 0.3, 8.1)]
    lines += [f"  - {{name: cabinet {k}, box: {list(box)}, height: 1.6}}" for k, box in enumerate(boxes)]
    return "\n".join(lines) + "\n"


def legs() -> list[tuple[float, float]]:
    """Metres ahead and radians to turn after them, counter-clockwise from the ring's lower left corner."""
    sides = [_LONG_M, _SHORT_M, _LONG_M, _SHORT_M]
    count = round(_LAPS * 4)
    return [(sides[k % 4], 0.5 * math.pi) for k in range(count)]


def rates() -> tuple[Floats, Floats]:
    """(N,) speed, m/s, and (N,) turn rate, rad/s, at every physical step."""
    speeds, turns = [np.zeros(1000)], [np.zeros(1000)]
    for ahead_m, turn_rad in legs():
        for column, (way, fastest, acceleration) in enumerate(
            ((ahead_m, _SPEED_MPS, _ACCELERATION_MPS2), (turn_rad, _TURN_RPS, _TURN_RPS2))
        ):
            rate = _trapezoid(way, fastest, acceleration)
            (speeds, turns)[column].append(rate)
            (turns, speeds)[column].append(np.zeros_like(rate))
    return np.concatenate(speeds), np.concatenate(turns)


def _trapezoid(way: float, fastest: float, acceleration: float) -> Floats:
    fastest = min(fastest, math.sqrt(way * acceleration))
    total_s = fastest / acceleration + way / fastest
    times = (np.arange(math.ceil(total_s / STEP_S)) + 0.5) * STEP_S
    rate = np.minimum(fastest, acceleration * np.minimum(times, np.maximum(total_s - times, 0.0)))
    return rate * (way / (rate.sum() * STEP_S))


def rows() -> Floats:
    """(N, 15) float64 states of the body, as a ``Track`` holds them."""
    speed, turn = rates()
    times = np.arange(len(speed)) * STEP_S
    yaw = np.cumsum(turn) * STEP_S
    axle = np.column_stack((np.cumsum(speed * np.cos(yaw)), np.cumsum(speed * np.sin(yaw)))) * STEP_S
    lean = np.gradient(speed, STEP_S) / _G_MPS2
    share = STEP_S / _LEAN_S
    for k in range(1, len(lean)):  # a body takes its time to lean
        lean[k] = lean[k - 1] + share * (lean[k] - lean[k - 1])
    pitch = lean + _SWAY_RAD * np.clip(times - 0.5, 0.0, 1.0) * np.sin(2.0 * math.pi * _SWAY_HZ * times)
    turned = Rotation.from_euler("ZY", np.column_stack((yaw, pitch)))
    velocity = speed[:, None] * np.column_stack((np.cos(yaw), np.sin(yaw)))
    felt = np.column_stack((np.gradient(velocity, STEP_S, axis=0), np.full(len(yaw), _G_MPS2)))
    spin = np.zeros((len(yaw), 3))
    spin[1:] = (turned[:-1].inv() * turned[1:]).as_rotvec() / STEP_S
    states = np.zeros((len(yaw), 15))
    states[:, :2], states[:, 2] = axle, WHEEL_RADIUS_M
    states[:, :3] -= turned.apply([0.0, 0.0, WHEEL_RADIUS_M])
    quaternions = np.roll(turned.as_quat(), 1, axis=1)
    flips = np.cumprod(np.where((quaternions[1:] * quaternions[:-1]).sum(axis=1) < 0.0, -1.0, 1.0))
    quaternions[1:] *= flips[:, None]
    states[:, 3:7] = quaternions
    states[:, 7:10], states[:, 10:13] = spin, turned.inv().apply(felt)
    return states


def measured(states: Floats, course: str, seed: int, folder: Path) -> Iterator[Measurement]:
    """What the sensors say along the course, in order of time."""
    path = folder / "ring.yaml"
    path.write_text(ring(course))
    world = load_world(path)
    options = MujocoOptions(world=path, camera="320x240", lidar_blocked=_BLOCKED)
    streams = np.random.default_rng(seed).spawn(5)
    scene = build_scene(world, Town(world, (0.0, 0.0)).crowd(streams[0]), streams[1])
    model = scene.spec.compile()
    surroundings = Surroundings(scene, model, 0.3)
    camera = RgbdCamera(model, surroundings, options, streams[4])
    sensors = (
        InertialUnit(options, streams[2]),
        VelodyneLike(surroundings, options, streams[3]),
        camera,
    )
    track = Track(states[0])
    try:
        for begin in range(1, len(states), _STEPS_AT_ONCE):
            for row in states[begin : begin + _STEPS_AT_ONCE]:
                track.add(row)
            found = [measurement for sensor in sensors for measurement in sensor.measure(track)]
            yield from sorted(found, key=lambda measurement: measurement.stamp_s)
    finally:
        camera.close()


@dataclass(frozen=True, slots=True)
class Row:
    """One line of the table; lengths in centimetres."""

    course: str
    seed: int
    camera: bool
    rmse_cm: float
    worst_cm: float
    end_cm: float
    closures: int
    ms_per_scan: float


def run(course: str, seed: int, states: Floats) -> list[Row]:
    """Both ways on the same measurements."""
    slams = [KissGtsam(KissGtsam.Options(camera_closures=on)) for on in (False, True)]
    for slam in slams:
        slam.setup(RobotContext(start=Pose2(0.0, 0.0, 0.0)))
    spent_s = [0.0, 0.0]
    with tempfile.TemporaryDirectory() as folder:
        for measurement in measured(states, course, seed, Path(folder)):
            for k, slam in enumerate(slams):
                begin = time.process_time()
                slam.update(measurement)
                spent_s[k] += time.process_time() - begin
    return [_row(course, seed, on, slam, states, spent_s[on]) for on, slam in enumerate(slams)]


def _row(course: str, seed: int, on: int, slam: KissGtsam, states: Floats, spent_s: float) -> Row:
    trajectory, figures = slam.trajectory(), slam.figures()
    steps = np.minimum(np.round(trajectory.stamps_s / STEP_S).astype(np.int64), len(states) - 1)
    off = 100.0 * np.hypot(*(trajectory.poses[:, :2] - states[steps, :2]).T)
    return Row(
        course,
        seed,
        bool(on),
        round(math.sqrt(float(np.mean(off**2))), 1),
        round(float(off.max()), 1),
        round(float(off[-1]), 1),
        int(figures["loop_closures"]),
        round(1000.0 * spent_s / figures["scans"], 1),
    )


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--courses", nargs="+", choices=_COURSES, default=_COURSES)
    parser.add_argument("--json", type=Path)
    arguments = parser.parse_args()
    print(describe_machine(), end="\n\n")
    states = rows()
    driven = np.hypot(*np.diff(states[:, :2], axis=0).T).sum()
    print(
        f"{len(states) * STEP_S / 60:.1f} min, {driven:.0f} m, {100 * _BLOCKED:.0f} % of the lidar covered\n"
    )
    print("| course | seed | camera closures | rmse cm | worst cm | end cm | closures | CPU ms / scan |")
    print("|---|---|---|---|---|---|---|---|")
    table: list[Row] = []
    for seed, course in itertools.product(range(arguments.seeds), arguments.courses):
        for row in run(course, seed, states):
            table.append(row)
            print(
                f"| {row.course} | {row.seed} | {'on' if row.camera else 'off'} | {row.rmse_cm} | "
                f"{row.worst_cm} | {row.end_cm} | {row.closures} | {row.ms_per_scan} |",
                flush=True,
            )
    if arguments.json:
        arguments.json.write_text(json.dumps([asdict(row) for row in table], indent=1))


if __name__ == "__main__":
    main()
