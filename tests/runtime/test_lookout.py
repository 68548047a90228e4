import dataclasses
import math

import numpy as np
import pytest

from explore_bt.runtime.lookout import Lookout
from explore_bt.testing.balancing_robot import BalancingRobot
from explore_bt.testing.fake_robot import full_circle_scan
from explore_bt.testing.scene3 import Prism, Scene3
from explore_bt.types import BodyShape, PointCloud, Pose2, Twist2

SHAPE = BodyShape(height_m=0.6)


def box(x0: float, y0: float, x1: float, y1: float, low: float = 0.0, high: float = 2.5) -> Prism:
    return Prism(np.array([(x0, y0), (x1, y0), (x1, y1), (x0, y1)]), low, high)


def room(*things: Prism) -> Scene3:
    sides = [box(-4.1, -4, -4, 4), box(4, -4, 4.1, 4), box(-4, -4.1, 4, -4), box(-4, 4, 4, 4.1)]
    return Scene3([*sides, *things])


def look(scene: Scene3, pitch_deg: float = 0.0, speed: float = 0.0) -> tuple[Lookout, BalancingRobot]:
    robot = BalancingRobot(scene, Pose2(0.0, 0.0, 0.0), pitch_rad=math.radians(pitch_deg))
    lookout = Lookout(SHAPE)
    for measurement in robot.drive(speed, 0.0, 2.0):
        lookout.hear(measurement, lambda _: Twist2(speed, 0.0))
    return lookout, robot


def ahead_m(lookout: Lookout, half_width_rad: float = 0.03) -> float:
    """The nearest that the scan shows straight ahead."""
    assert lookout.scan is not None
    return float(np.nanmin(lookout.scan.ranges_m[np.abs(lookout.scan.angles_rad) < half_width_rad]))


@pytest.mark.parametrize("pitch_deg", [0.0, 9.0])
def test_a_level_floor_is_no_obstacle_however_the_body_swings(pitch_deg: float) -> None:
    lookout, _ = look(room(), pitch_deg)
    assert lookout.scan is not None
    ranges = lookout.scan.ranges_m
    assert np.nanmin(ranges) > 3.9
    assert not np.isnan(ranges).any()


def test_an_overhang_below_the_robot_s_height_counts_and_one_above_does_not() -> None:
    low, _ = look(room(box(1.5, -0.5, 2.5, 0.5, 0.4, 0.45)))
    high, _ = look(room(box(1.5, -0.5, 2.5, 0.5, 0.7, 0.75)))
    assert ahead_m(low) == pytest.approx(1.5, abs=0.1)
    assert ahead_m(high) > 3.8


def test_a_thin_leg_counts() -> None:
    lookout, _ = look(room(box(1.5, -0.02, 1.54, 0.02, 0.0, 0.7)))
    assert ahead_m(lookout) == pytest.approx(1.5, abs=0.08)


def test_a_sill_is_driven_over_and_a_step_is_not() -> None:
    sill, _ = look(room(box(1.9, -1.0, 2.2, 1.0, 0.0, 0.02)))
    step, _ = look(room(box(2.2, -1.0, 2.6, 1.0, 0.0, 0.2)))
    assert ahead_m(sill) > 3.8
    assert ahead_m(step) == pytest.approx(2.2, abs=0.1)


def test_speed_that_was_told_is_not_taken_for_a_slope() -> None:
    lookout, robot = look(room(), pitch_deg=5.0, speed=0.4)
    wall_m = 4.0 - robot.pose.x
    assert ahead_m(lookout) == pytest.approx(wall_m, abs=0.1)


def test_a_planar_lidar_is_listened_to_instead() -> None:
    lookout, robot = look(room())
    planar = full_circle_scan(2.0)
    lookout.hear(planar, lambda _: Twist2())
    for measurement in robot.drive(0.0, 0.0, 0.3):
        lookout.hear(measurement, lambda _: Twist2())
    assert lookout.scan is planar


def test_a_sweep_that_cannot_be_read_leaves_the_scan_to_grow_old() -> None:
    lookout, robot = look(room())
    before = lookout.scan
    for measurement in robot.drive(0.0, 0.0, 0.3):
        if isinstance(measurement, PointCloud):
            measurement = dataclasses.replace(measurement, times_s=measurement.times_s[:-1])
        lookout.hear(measurement, lambda _: Twist2())
    assert lookout.scan is before


def test_a_wall_that_many_returns_are_of_is_not_seen_too_near() -> None:
    """0.7 m away each direction has a dozen returns of 2 cm noise: the nearest of them is 3 cm too near."""
    lookout, _ = look(room(box(0.7, -1.0, 0.8, 1.0)))
    assert lookout.scan is not None
    ahead = np.abs(lookout.scan.angles_rad) < 0.4
    away = lookout.scan.ranges_m[ahead] * np.cos(lookout.scan.angles_rad[ahead])
    assert float(np.mean(away)) == pytest.approx(0.7, abs=0.006)
    assert float(np.std(away)) < 0.012
