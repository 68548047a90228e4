from __future__ import annotations

import math

import numpy as np
from explore_bt_slam.back_end import BackEnd
from explore_bt_slam.front_end import FrontEnd, Registered
from explore_bt_slam.options import KissGtsamOptions

from explore_bt.testing.slam_room import Room
from explore_bt.types import Imu, Pose2, Scan2D


def wall(x0: float, y0: float, x1: float, y1: float) -> list[float]:
    return [x0, y0, x1, y1]


def scan_at(room: list[list[float]], pose: Pose2, stamp_s: float, range_m: float) -> Scan2D:
    angles = np.linspace(-np.pi, np.pi, 360, endpoint=False)
    world = Room(np.array(room), np.zeros((0, 3)))
    ranges = world.ranges(np.tile(pose.xy, (360, 1)), angles + pose.yaw_rad)
    ranges = np.where(ranges > range_m, np.inf, ranges).astype(np.float32)
    return Scan2D(stamp_s, angles, ranges, np.zeros(360), 0.05, range_m)


def second_scan(known: list[list[float]], seen: list[list[float]], range_m: float) -> Registered:
    """A robot at rest maps what is known, and then sees something else."""
    front, back, here = FrontEnd(KissGtsamOptions(), 0.5), BackEnd(loop_closures=False), Pose2.identity()
    for k in range(-100, 1):
        front.take_imu(Imu(0.01 * k, (0.0, 0.0, 0.0), (0.0, 0.0, 9.81)))
    first = front.first(scan_at(known, here, 0.0, 10.0), here)
    back.begin(first.sweep, first.pose)
    front.relocate(*back.surroundings(0))
    for k in range(1, 11):
        front.take_imu(Imu(0.01 * k, (0.0, 0.0, 0.0), (0.0, 0.0, 9.81)))
    return front.register(scan_at(seen, here, 0.1, range_m), here)


NEAR = [wall(-2.0, 2.0, 2.0, 2.0), wall(2.0, -1.0, 2.0, 2.0)]
FAR = [wall(-2.0, 6.0, 2.0, 6.0)]


def test_new_walls_far_from_all_known_ones_contradict_nothing() -> None:
    """The lidar does not reach the map's walls from here: what it meets instead is simply new."""
    registered = second_scan(FAR, NEAR, 4.0)
    assert registered.fits
    assert not registered.problem
    assert registered.pose.distance_to(Pose2.identity()) < 0.01


def test_walls_that_seem_turned_do_not_turn_a_robot_that_felt_nothing() -> None:
    turned = [
        [*Pose2(0.0, 0.0, 0.12).apply(np.array([[x0, y0], [x1, y1]])).ravel().tolist()]
        for x0, y0, x1, y1 in NEAR
    ]
    registered = second_scan(NEAR, turned, 10.0)
    assert abs(registered.pose.yaw_rad) < math.radians(0.5)
