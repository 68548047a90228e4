import math

import numpy as np
from explore_bt_drivers.mujoco.track import STEP_S, Track


def row(step: int) -> np.ndarray:
    """A body that goes 1 m/s along x and turns 1 rad/s."""
    time_s = step * STEP_S
    state = np.zeros(15)
    state[0], state[3], state[6] = time_s, math.cos(0.5 * time_s), math.sin(0.5 * time_s)
    state[13:] = time_s
    return state


def track_to(last_step: int) -> Track:
    track = Track(row(0))
    for step in range(1, last_step + 1):
        track.add(row(step))
    return track


def test_states_belong_to_their_steps_however_long_the_way() -> None:
    track = track_to(10_000)
    assert track.last_step == 10_000
    assert len(track.times_s) == len(track.positions) >= 2.0 / STEP_S
    np.testing.assert_allclose(track.positions[:, 0], track.times_s)
    np.testing.assert_allclose(track.wheels_rad[:, 1], track.times_s)


def test_poses_between_steps_lie_between() -> None:
    track = track_to(1000)
    times = np.random.default_rng(1).uniform(0.5, 2.0, 200)
    positions, quaternions = track.at(times)
    np.testing.assert_allclose(positions[:, 0], times, atol=1e-12)
    np.testing.assert_allclose(2.0 * np.arctan2(quaternions[:, 3], quaternions[:, 0]), times, atol=1e-9)


def test_beyond_its_ends_a_track_gives_its_ends() -> None:
    positions, _ = track_to(10).at(np.array([-1.0, 5.0]))
    np.testing.assert_allclose(positions[:, 0], [0.0, 10 * STEP_S])


def test_a_track_of_one_state_has_a_pose() -> None:
    positions, quaternions = Track(row(0)).at(np.array([0.0, 1.0]))
    np.testing.assert_allclose(positions, 0.0)
    np.testing.assert_allclose(quaternions, [[1, 0, 0, 0]] * 2)


def test_samples_fall_due_on_their_step() -> None:
    track = track_to(49)
    assert track.due(10.0) == 0
    track.add(row(50))
    assert track.due(10.0) == 1
    assert track.due(250.0) == 25
