from __future__ import annotations

import math

import numpy as np
from explore_bt_slam.sweep import Sweep, deskew
from explore_bt_slam.trail import Trail

from explore_bt.types import Pose2, Scan2D


def scan(ranges: list[float], angles: list[float], times: list[float], mount: Pose2 | None = None) -> Scan2D:
    return Scan2D(
        1.0, np.array(angles), np.array(ranges, np.float32), np.array(times), 0.1, 8.0,
        T_base_sensor=mount or Pose2.identity(),
    )  # fmt: skip


def test_each_beam_is_taken_to_where_the_robot_was_when_it_was_measured() -> None:
    times = np.linspace(0.9, 1.0, 11)
    poses = np.column_stack((0.5 * (times - 0.9), 0.0 * times, 1.2 * (times - 0.9)))
    mount = Pose2(0.1, 0.05, 0.3)
    taken = scan([2.0, 3.0, 1.0], [0.1, 1.0, -2.0], [-0.1, -0.043, 0.0], mount)
    sweep = deskew(taken, Trail(times, poses), 8.0)
    end = Pose2(*poses[-1])
    for i, time_s in enumerate([0.9, 0.957, 1.0]):
        then = Pose2(0.5 * (time_s - 0.9), 0.0, 1.2 * (time_s - 0.9))
        sensor = end.between(then).compose(mount)
        reach, angle = float(taken.ranges_m[i]), float(taken.angles_rad[i])
        tip = sensor.apply(np.array([[reach * math.cos(angle), reach * math.sin(angle)]]))[0]
        assert np.allclose(sweep.ends[i], tip, atol=1e-6)
        assert np.allclose(sweep.origins[i], sensor.xy, atol=1e-6)


def test_invalid_beams_are_dropped_and_open_ones_are_cut_at_the_range() -> None:
    ranges = [math.nan, math.inf, 0.05, 9.0, 6.0, 2.0]
    sweep = deskew(scan(ranges, [0.0] * 6, [0.0] * 6), Trail.standing(1.0), 5.0)
    assert sweep.hit.tolist() == [False, False, True]
    assert np.allclose(sweep.ends[:, 0], [5.0, 5.0, 2.0])


def test_a_corrected_trail_ends_where_it_is_told_and_begins_where_it_began() -> None:
    times = np.array([0.0, 0.05, 0.1])
    trail = Trail(times, np.array([[0.0, 0.0, 0.0], [0.02, 0.0, 0.05], [0.05, 0.0, 0.1]]))
    bent = trail.corrected_to(Pose2(0.06, 0.01, 0.08))
    assert np.allclose(bent.poses[0], 0.0)
    assert np.allclose(bent.poses[1], [0.025, 0.005, 0.04])
    assert np.allclose(bent.poses[2], [0.06, 0.01, 0.08])


def test_a_cut_sweep_keeps_near_returns_and_clears_up_to_the_cut() -> None:
    ends = np.array([[1.0, 0.0], [0.0, 8.0], [6.0, 0.0]], np.float32)
    sweep = Sweep(0.0, np.zeros((3, 2), np.float32), ends, np.array([True, True, False]))
    cut = sweep.cut(5.0)
    assert np.allclose(cut.ends, [[1.0, 0.0], [0.0, 5.0], [5.0, 0.0]])
    assert cut.hit.tolist() == [True, False, False]
    assert sweep.cut(9.0) is sweep
