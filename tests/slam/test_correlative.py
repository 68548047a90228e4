from __future__ import annotations

import numpy as np
from explore_bt_slam.correlative import ScoreGrid, search
from numpy.typing import NDArray

from explore_bt.types import Pose2


def corner(seed: int = 0) -> NDArray[np.float64]:
    """An L of walls with a pillar, as (N, 2) points."""
    rng = np.random.default_rng(seed)
    along = np.linspace(0.0, 3.0, 60)
    walls = np.vstack((np.column_stack((along, 0.0 * along)), np.column_stack((0.0 * along, 0.6 * along))))
    pillar = np.column_stack((1.5 + 0.1 * np.cos(along), 1.0 + 0.1 * np.sin(along)))
    return np.vstack((walls, pillar)) + rng.normal(0.0, 0.005, (180, 2))


def brute_force(
    grid: ScoreGrid, points: NDArray[np.float64], centre: Pose2, reach: int, angles: NDArray[np.float64]
) -> float:
    """The best total over every rotation and every offset, without bounds."""
    best = 0.0
    for yaw in angles:
        cells = np.floor(
            (Pose2(centre.x, centre.y, float(yaw)).apply(points) - grid.origin_xy) / 0.05
        ).astype(int)
        for dr in range(-reach, reach + 1):
            for dc in range(-reach, reach + 1):
                rows, cols = cells[:, 1] + dr, cells[:, 0] + dc
                inside = (
                    (rows >= 0) & (cols >= 0) & (rows < grid.scores.shape[0]) & (cols < grid.scores.shape[1])
                )
                best = max(best, float(grid.scores[rows[inside], cols[inside]].astype(np.float64).sum()))
    return best / points.shape[0]


def test_branch_and_bound_finds_what_brute_force_finds() -> None:
    for seed in range(3):
        rng = np.random.default_rng(seed)
        truth = Pose2(*rng.uniform(-0.3, 0.3, 2), float(rng.uniform(-0.1, 0.1)))
        world = corner(seed)
        points = truth.inverse().apply(world)[::3]
        grid = ScoreGrid(world, 0.5)
        match = search(grid, points, Pose2.identity(), 0.5, 0.15)
        step = 0.05 / float(np.hypot(*points.T).max())
        turns = int(np.ceil(0.15 / step))
        slow = brute_force(grid, points, Pose2.identity(), 10, step * np.arange(-turns, turns + 1))
        assert abs(match.score - slow) < 1e-6
        assert match.pose.distance_to(truth) < 0.06


def test_the_bound_is_never_below_any_score_of_its_block() -> None:
    grid = ScoreGrid(corner(), 0.5)
    for level in range(grid.pyramid.shape[0]):
        side = 2**level
        for row in range(0, grid.scores.shape[0], 7):
            for col in range(0, grid.scores.shape[1], 7):
                block = grid.scores[row : row + side, col : col + side]
                assert grid.pyramid[level, row, col] == block.max()


def test_a_comb_of_equal_pillars_is_ambiguous_and_a_corner_is_not() -> None:
    ring = np.linspace(0.0, 2.0 * np.pi, 12, endpoint=False)
    pillar = 0.1 * np.column_stack((np.cos(ring), np.sin(ring)))
    comb = np.vstack([pillar + np.array([k, 0.0]) for k in range(7)])
    seen = np.vstack([pillar + np.array([k, 0.0]) for k in range(3)])
    match = search(ScoreGrid(comb, 0.5), seen, Pose2(2.0, 0.0, 0.0), 1.5, 0.1)
    assert match.runner_up > 0.85 * match.score
    match = search(ScoreGrid(corner(), 0.5), corner(1), Pose2(0.1, 0.1, 0.0), 1.0, 0.1)
    assert match.runner_up < 0.85 * match.score


def test_where_nothing_is_known_or_seen_nothing_scores() -> None:
    centre, nothing = Pose2(1.0, 2.0, 0.5), np.zeros((0, 2))
    assert search(ScoreGrid(nothing, 0.5), corner(), centre, 0.5, 0.1).score == 0.0
    unseen = search(ScoreGrid(corner(), 0.5), nothing, centre, 0.5, 0.1)
    assert (unseen.pose, unseen.score, unseen.runner_up) == (centre, 0.0, 0.0)
