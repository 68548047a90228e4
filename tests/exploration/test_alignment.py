import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import minimize

from explore_bt.errors import UserError
from explore_bt.exploration import align_se2, ate_rmse_m
from explore_bt.types import Pose2, Trajectory


def course(seed, count=30):
    rng = np.random.default_rng(seed)
    return Trajectory(np.arange(count) * 0.5, np.cumsum(rng.normal(size=(count, 3)), axis=0))


def moved(trajectory, motion, noise=0.0, seed=0):
    poses = trajectory.poses.copy()
    poses[:, :2] = (
        motion.apply(poses[:, :2]) + np.random.default_rng(seed).normal(0, 1, (len(poses), 2)) * noise
    )
    return Trajectory(trajectory.stamps_s, poses)


motion = st.builds(Pose2, st.floats(-9, 9), st.floats(-9, 9), st.floats(-3, 3))


@settings(deadline=None, max_examples=30)
@given(motion, st.integers(0, 99))
def test_a_moved_trajectory_has_no_error_once_aligned(shift, seed):
    truth = course(seed)
    assert ate_rmse_m(moved(truth, shift), truth) == pytest.approx(0.0, abs=1e-9)


@settings(deadline=None, max_examples=15)
@given(motion, st.integers(0, 99))
def test_no_rigid_motion_fits_better_than_the_alignment(shift, seed):
    truth = course(seed)
    estimate = moved(truth, shift, noise=0.4, seed=seed)

    def rmse(x):
        off = Pose2(*x).apply(estimate.poses[:, :2]) - truth.poses[:, :2]
        return math.sqrt((off**2).sum(axis=1).mean())

    found = ate_rmse_m(estimate, truth)
    best = align_se2(estimate.poses[:, :2], truth.poses[:, :2])
    assert found == pytest.approx(rmse(best.as_array()))
    search = minimize(
        rmse, best.as_array() + 0.05, method="Nelder-Mead", options={"xatol": 1e-7, "fatol": 1e-10}
    )
    assert found == pytest.approx(search.fun, abs=1e-6)


def test_without_alignment_an_offset_is_the_error():
    truth = course(1)
    assert ate_rmse_m(moved(truth, Pose2(3.0, 4.0, 0.0)), truth, align=False) == pytest.approx(5.0)


def test_the_truth_is_interpolated_at_the_estimates_stamps():
    truth = Trajectory(np.array([0.0, 10.0]), np.array([[0.0, 0, 0], [10.0, 5.0, 0]]))
    stamps = np.array([1.0, 2.5, 7.0])
    estimate = Trajectory(stamps, np.column_stack((stamps, stamps / 2, stamps * 0)))
    assert ate_rmse_m(estimate, truth, align=False) == pytest.approx(0.0)


def test_stamps_outside_the_truth_are_left_out():
    truth = Trajectory(np.array([0.0, 1.0]), np.zeros((2, 3)))
    estimate = Trajectory(np.array([-5.0, 0.5, 9.0]), np.array([[99.0, 0, 0], [0, 0, 0], [99.0, 0, 0]]))
    assert ate_rmse_m(estimate, truth, align=False) == 0.0


def test_a_robot_that_stood_still_is_aligned_without_rotation():
    still = np.zeros((4, 2))
    assert align_se2(still + 2.0, still) == Pose2(-2.0, -2.0, 0.0)


def test_trajectories_of_different_times_are_refused():
    truth = Trajectory(np.array([0.0, 1.0]), np.zeros((2, 3)))
    late = Trajectory(np.array([5.0]), np.zeros((1, 3)))
    for reference in (truth, Trajectory(np.empty(0), np.empty((0, 3)))):
        with pytest.raises(UserError, match="none of 1 estimated poses"):
            ate_rmse_m(late, reference)
