"""What is the RGB-D camera worth, and what does it cost?  python benchmarks/camera.py [--seeds 2].

A loop of 125 m: one long side is a plain corridor, the other has the same niche every 1.2 m on both sides;
each wall has a texture of its own. 30 % of the lidar's beams are blocked, and the accelerometer feels a push
that is not there while the robot drives through the plain corridor. The same measurements go to
``kiss_gtsam`` with camera closures off and on.
"""

from __future__ import annotations

import argparse
import dataclasses
import math
import time
from collections.abc import Iterator

import numpy as np
from explore_bt_slam import KissGtsam
from explore_bt_slam.sight import SightMaker
from explore_bt_slam.sight_store import SightStore
from machine import describe_machine

from explore_bt.interfaces import RobotContext
from explore_bt.testing.slam_camera import RoomCamera, filmed
from explore_bt.testing.slam_room import Room, ScriptedRobot
from explore_bt.types import Imu, Measurement, Pose2, Scan2D

_LENGTH_M = 50.0
_START = Pose2(-0.5 * _LENGTH_M + 8.0, 3.75, -math.pi)
_LEGS_M = (8.8, 7.6, _LENGTH_M + 1.6, 7.6, _LENGTH_M - 1.2)
_PLAIN_LEG = 2
_SPEED_MPS = 0.5
_PUSH_MPS2 = 0.06


def course() -> Room:
    """A corridor 1.6 m wide about a core of 50 × 6 m, with niches along its upper side."""
    half = 0.5 * _LENGTH_M
    boxes = [(-half, -3.0, half, 3.0), (-half - 1.6, -4.6, half + 1.6, 4.6)]
    for x in np.arange(-half + 0.6, half - 0.4, 1.2):
        boxes += [(x, 4.3, x + 0.4, 4.6), (x, 3.0, x + 0.4, 3.2)]
    corners = [np.array([[x0, y0], [x1, y0], [x1, y1], [x0, y1]]) for x0, y0, x1, y1 in boxes]
    walls = [np.hstack((each, np.roll(each, -1, axis=0))) for each in corners]
    return Room(np.vstack(walls), np.zeros((0, 3)))


def drive(robot: ScriptedRobot, camera: RoomCamera) -> Iterator[Measurement]:
    """The loop, and on past the start by 6 m."""
    for leg, length_m in enumerate(_LEGS_M):
        for measurement in filmed(robot, camera, robot.drive(_SPEED_MPS, 0.0, length_m / _SPEED_MPS)):
            yield _spoilt(measurement, _PUSH_MPS2 if leg == _PLAIN_LEG else 0.0)
        if leg < len(_LEGS_M) - 1:
            for measurement in filmed(robot, camera, robot.drive(0.0, 1.0, 0.5 * math.pi)):
                yield _spoilt(measurement, 0.0)


def run(seed: int, camera_closures: bool) -> str:
    """One row of the table."""
    room = course()
    robot = ScriptedRobot(room, _START, seed)
    camera = RoomCamera(room, np.arange(len(room.segments)), seed)
    slam = KissGtsam(KissGtsam.Options(camera_closures=camera_closures))
    slam.setup(RobotContext(start=_START))
    spent_s = 0.0
    for measurement in drive(robot, camera):
        begin = time.process_time()
        slam.update(measurement)
        spent_s += time.process_time() - begin
    trajectory, figures = slam.trajectory(), slam.figures()
    truth = np.array([robot.pose_at(stamp_s).as_array() for stamp_s in trajectory.stamps_s])
    off = np.hypot(*(trajectory.poses - truth)[:, :2].T)
    share_ms = 1000.0 * spent_s / figures["scans"]
    return (
        f"| {seed} | {'on' if camera_closures else 'off'} | {100.0 * math.sqrt(np.mean(off**2)):.1f} | "
        f"{100.0 * off.max():.1f} | {100.0 * off[-1]:.1f} | {figures['loop_closures']:.0f} | "
        f"{figures['ms_per_scan_median']:.1f} | {figures['ms_per_scan_p99']:.1f} | {share_ms:.2f} |"
    )


def growth(counts: tuple[int, ...]) -> list[str]:
    """What a keyframe's image costs when so many others are remembered, each of another place."""
    room, maker, store = Room.furnished(), SightMaker(), SightStore()
    rng, rows, made, asked, filed = np.random.default_rng(0), [], [], [], []
    for number in range(max(counts) + 1):
        camera = RoomCamera(room, np.arange(len(room.segments)) + number * len(room.segments))
        frame = camera.frame(0.0, Pose2(*rng.uniform(-1.0, 1.0, 2).tolist(), float(rng.uniform(-3.0, 3.0))))
        stamps = [time.process_time()]
        sight = maker.sight(frame, Pose2.identity())
        stamps.append(time.process_time())
        store.votes(sight)
        stamps.append(time.process_time())
        store.add(number, sight)
        stamps.append(time.process_time())
        for series, spent_s in zip((made, asked, filed), np.diff(stamps), strict=True):
            series.append(1000.0 * float(spent_s))
        if number in counts:
            medians = (float(np.median(series[-50:])) for series in (made, asked, filed))
            rows.append(f"| {number} | " + " | ".join(f"{value:.1f}" for value in medians) + " |")
    return rows


def main() -> None:
    """Print both tables."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seeds", type=int, default=2, help="seeds 0 to N-1")
    arguments = parser.parse_args()
    print(f"{describe_machine()}\n")
    print(
        "| seed | camera closures | rmse cm | worst cm | end cm | closures | ms / scan | p99 | mean CPU ms |"
    )
    print("|---|---|---|---|---|---|---|---|---|")
    for seed in range(arguments.seeds):
        for camera_closures in (False, True):
            print(run(seed, camera_closures), flush=True)
    print("\n| sights remembered | features ms | search ms | filing ms |\n|---|---|---|---|")
    print("\n".join(growth((100, 500, 1000, 2000, 2500))))


def _spoilt(measurement: Measurement, push_mps2: float) -> Measurement:
    """A scan without the 108° behind the robot; an accelerometer that feels what is not there."""
    if isinstance(measurement, Scan2D):
        ranges = measurement.ranges_m.copy()
        ranges[np.abs(measurement.angles_rad) > 0.7 * math.pi] = np.nan
        return dataclasses.replace(measurement, ranges_m=ranges)
    if isinstance(measurement, Imu):
        x, y, z = measurement.linear_acceleration_mps2
        return dataclasses.replace(measurement, linear_acceleration_mps2=(x + push_mps2, y, z))
    return measurement


if __name__ == "__main__":
    main()
