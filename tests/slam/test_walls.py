from __future__ import annotations

import numpy as np
from explore_bt_slam.walls import filled_walls
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray


def corridor(half_width_m: float, shift_m: float, noise_m: float = 0.0) -> NDArray[np.float64]:
    """Returns of 180 beams up to 15 m in a plain corridor along x, seen from its middle line."""
    angles = np.radians(np.arange(-89.5, 90.0))
    ranges = np.minimum(half_width_m / np.abs(np.sin(angles)), 15.0 + shift_m)
    ranges = ranges + np.random.default_rng(0).normal(0.0, noise_m, ranges.shape)
    ends = ranges[:, None] * np.column_stack((np.cos(angles), np.sin(angles)))
    return np.asarray(ends[ranges < 14.0])


@settings(deadline=None)  # the first call compiles
@given(st.floats(0.8, 3.0), st.floats(0.0, 0.01))
def test_what_is_filled_in_lies_on_walls_and_looks_at_the_robot(half_width_m: float, noise_m: float) -> None:
    points, normals = filled_walls(corridor(half_width_m, 0.0, noise_m))
    assert len(points) > 20
    assert np.abs(np.abs(points[:, 1]) - half_width_m).max() < 5.0 * noise_m + 1e-9
    assert np.allclose(np.hypot(normals[:, 0], normals[:, 1]), 1.0)
    assert (normals[:, 1] * points[:, 1] < 0.0).all()


def test_gaps_of_a_straight_wall_shorter_than_a_metre_leave_no_hole() -> None:
    seen = corridor(1.2, 0.0)
    points, _ = filled_walls(seen)
    left = np.sort(np.concatenate((seen, points))[np.concatenate((seen, points))[:, 1] > 0.0, 0])
    near = left[left < 6.0]
    assert np.diff(near).max() <= 0.1 + 1e-9


def test_a_doorway_stays_open() -> None:
    x = np.arange(-2.0, 2.0, 0.15)
    wall = np.column_stack((x, np.full_like(x, 1.0)))
    wall = wall[(wall[:, 0] < -0.4) | (wall[:, 0] > 0.4)]
    points, _ = filled_walls(wall)
    assert len(points) > 0
    assert not ((points[:, 0] > -0.35) & (points[:, 0] < 0.35)).any()


def test_corners_and_scattered_points_are_not_joined() -> None:
    rng = np.random.default_rng(0)
    assert len(filled_walls(np.array([[0.0, 2.0], [0.5, 2.0], [0.5, 2.5], [1.0, 2.5]]))[0]) == 0
    assert len(filled_walls(rng.uniform(-5.0, 5.0, (30, 2)))[0]) == 0
    assert len(filled_walls(np.zeros((0, 2)))[0]) == 0
