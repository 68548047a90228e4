from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from explore_bt.runtime.centred import centred
from explore_bt.types import FREE, OccupancyGrid, Path

RADIUS_M = 0.25
FLOOR = OccupancyGrid(np.full((80, 120), FREE, dtype=np.int8), 0.05, (-3.0, -2.0))


def gap(width_m: float, middle_m: float) -> np.ndarray:
    """Returns from the two jambs of a doorway at x = 0, 0.2 m deep, and from the walls beside it."""
    ys = np.arange(0.0, 1.0, 0.01)
    xs = np.arange(-0.1, 0.1, 0.01)
    above, below = middle_m + width_m / 2.0, middle_m - width_m / 2.0
    sides = [np.column_stack((xs, np.full_like(xs, y))) for y in (above, below)]
    walls = [np.column_stack((np.full_like(ys, -0.1), y)) for y in (above + ys, below - ys)]
    return np.concatenate((*sides, *walls))


def straight(y: float, clearance_m: float = 0.23) -> Path:
    """Along x through the gap; tight within half a metre of it."""
    xs = np.arange(-1.5, 1.51, 0.05)
    poses = np.column_stack((xs, np.full_like(xs, y), np.zeros_like(xs)))
    return Path(poses, np.where(np.abs(xs) < 0.3, clearance_m, 0.8))


def room_m(path: Path, points: np.ndarray) -> float:
    apart = path.poses[:, None, :2] - points[None]
    return float(np.hypot(apart[..., 0], apart[..., 1]).min())


@settings(deadline=None, max_examples=40)
@given(st.floats(0.52, 0.62), st.floats(-0.04, 0.04), st.integers(0, 999))
def test_a_path_beside_the_middle_of_a_gap_is_moved_into_it(width_m: float, off_m: float, seed: int) -> None:
    points = gap(width_m, off_m) + np.random.default_rng(seed).normal(0.0, 0.003, (240, 2))
    moved = centred(straight(0.0), points, FLOOR, RADIUS_M)
    assert room_m(moved, points) >= width_m / 2.0 - 0.016
    assert room_m(moved, points) >= room_m(straight(0.0), points) - 0.005


def test_the_ends_stay_and_no_step_is_abrupt() -> None:
    moved = centred(straight(0.0), gap(0.55, 0.04), FLOOR, RADIUS_M)
    np.testing.assert_allclose(moved.poses[[0, -1]], straight(0.0).poses[[0, -1]])
    assert np.abs(np.diff(moved.poses[:, 1])).max() < 0.015
    heading = np.arctan2(np.diff(moved.poses[:, 1]), np.diff(moved.poses[:, 0]))
    assert np.abs(moved.poses[1:-1, 2] - heading[1:]).max() < 0.15


@pytest.mark.parametrize(
    ("path", "points"),
    [
        (straight(0.0, clearance_m=0.31), gap(0.7, 0.03)),
        (straight(0.0), np.empty((0, 2))),
        (straight(0.0), gap(0.55, 0.0) + np.array([50.0, 0.0])),
    ],
)
def test_roomy_paths_and_those_the_scan_says_nothing_about_stay(path: Path, points: np.ndarray) -> None:
    np.testing.assert_allclose(centred(path, points, FLOOR, RADIUS_M).poses, path.poses, atol=1e-12)


def test_what_the_map_says_of_the_moved_poses_is_told() -> None:
    cells = np.full((80, 120), FREE, dtype=np.int8)
    cells[45, 55:65] = 100  # y = 0.25 … 0.30
    moved = centred(straight(0.0), gap(0.55, 0.04), OccupancyGrid(cells, 0.05, (-3.0, -2.0)), RADIUS_M)
    assert (moved.clearance_m <= straight(0.0).clearance_m).all()
    assert moved.clearance_m.min() == pytest.approx(0.2, abs=0.026)
