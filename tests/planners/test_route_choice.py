"""Which of several ways is taken: the kept one, the widest one, and where a goal at a frontier is met."""

import math

import numpy as np
import pytest
from explore_bt_planners import Skeleton
from explore_bt_planners.feature_transform import feature_transform
from scipy.ndimage import label

from explore_bt.errors import GoalBlocked, NoPath
from explore_bt.exploration.clearance import clearance_field
from explore_bt.testing.planner_contract import exact_clearance, points_along
from explore_bt.types import FREE, OCCUPIED, UNKNOWN, OccupancyGrid, Pose2

R = 0.25
WEST, EAST = Pose2(0.75, 2.5, 0.0), Pose2(7.25, 2.5, 0.0)


def skeleton(**options):
    return Skeleton(Skeleton.Options(**options))


def ring(revision, noise_seed=None, block_above=False):
    """Two ways of one length around a block, walls redrawn with noise."""
    cells = np.full((100, 160), FREE, dtype=np.int8)
    cells[[0, -1]], cells[:, [0, -1]] = OCCUPIED, OCCUPIED
    cells[25:75, 30:130] = OCCUPIED
    if noise_seed is not None:
        rng = np.random.default_rng(noise_seed)
        for c in range(1, 159):
            cells[1 : 1 + rng.integers(0, 8), c] = OCCUPIED
            cells[99 - rng.integers(0, 8) : 99, c] = OCCUPIED
    if block_above:
        cells[75:, 80] = OCCUPIED
    return OccupancyGrid(cells, 0.05, (0.0, 0.0), revision)


def goes_above(path):
    return bool(path.poses[len(path.poses) // 2, 1] > 2.5)


def sides(planner):
    return [goes_above(planner.plan(ring(k, k), WEST, EAST, R)) for k in range(1, 25)]


def test_redrawn_noise_does_not_flip_a_route_that_is_kept():
    flipping = sides(skeleton(hysteresis=0.0))
    assert len(set(flipping)) == 2, "this noise flips nothing: the test is none"
    assert len(set(sides(skeleton()))) == 1


def test_a_route_that_is_cut_or_became_clearly_dearer_is_left():
    planner = skeleton()
    above = goes_above(planner.plan(ring(1), WEST, EAST, R))
    for revision in (2, 3, 4):
        path = planner.plan(ring(revision, block_above=True), WEST, EAST, R)
        assert not goes_above(path)
    opened = planner.plan(ring(5), WEST, EAST, R)
    assert not goes_above(opened), "both ways cost the same: the one that is driven is kept"
    nearer_above = Pose2(2.0, 4.4, 0.0)
    assert goes_above(planner.plan(ring(6), nearer_above, EAST, R))
    assert isinstance(above, bool)


def test_a_kept_route_is_as_clear_and_ends_where_it_should():
    planner = skeleton()
    for k in range(1, 12):
        grid = ring(k, k)
        path = planner.plan(grid, WEST, EAST, R)
        points, _ = points_along(path, 0.02)
        assert exact_clearance(grid, points).min() >= R
        assert path.goal.distance_to(EAST) < 1e-6
        assert path.poses[0, :2].tolist() == pytest.approx(list(WEST.xy))


def test_an_older_or_equal_revision_is_planned_as_if_for_the_first_time():
    planner = skeleton()
    planner.plan(ring(7, 3), WEST, EAST, R)
    for revision in (7, 2):
        for seed in range(6):
            grid = ring(revision, seed)
            fresh = skeleton().plan(grid, WEST, EAST, R)
            assert np.array_equal(planner.plan(grid, WEST, EAST, R).poses, fresh.poses)


def test_travel_time_as_price_avoids_the_gap_that_is_driven_at_a_crawl():
    cells = np.full((120, 160), FREE, dtype=np.int8)
    cells[:, 78:82] = OCCUPIED
    cells[50:62, 78:82], cells[80:115, 78:82] = FREE, FREE  # a tight gap ahead, a wide one aside
    for c in range(70, 90):
        cells[[49, 62], c] = OCCUPIED
    grid = OccupancyGrid(cells, 0.05, (0.0, 0.0), 1)
    start, goal = Pose2(2.5, 2.8, 0.0), Pose2(5.5, 2.8, 0.0)
    short = skeleton(clearance_weight=0.0).plan(grid, start, goal, R)
    quick = skeleton(slow_below=0.1).plan(grid, start, goal, R)
    assert seconds(quick) < seconds(short)
    assert quick.length_m > short.length_m


def seconds(path):
    """Driven at 0.5 m/s, less in proportion where there is less than 0.1 m beside the footprint."""
    steps = np.hypot(*np.diff(path.poses[:, :2], axis=0).T)
    room = path.clearance_m[1:] - (R + 0.02)
    return float((steps / (0.5 * np.clip(room / 0.1, 0.2, 1.0))).sum())


def clutter(seed):
    rng = np.random.default_rng(seed)
    cells = np.full((130, 130), FREE, dtype=np.int8)
    for r, c in rng.integers(0, 120, size=(38, 2)):
        cells[r : r + rng.integers(1, 14), c : c + rng.integers(1, 14)] = rng.choice([OCCUPIED, UNKNOWN])
    return OccupancyGrid(cells, 0.05, (-1.0, 0.5))


def slow_widest(field, start, goal):
    """Greatest clearance at which both cells lie in one piece: bisection, every piece labelled by scipy."""
    levels = np.unique(field[field > 0])
    low, high = -1, len(levels)
    while high - low > 1:
        middle = (low + high) // 2
        pieces, _ = label(field >= levels[middle])
        joined = pieces[start] and pieces[start] == pieces[goal]
        low, high = (middle, high) if joined else (low, middle)
    return float(levels[low]) if low >= 0 else 0.0


@pytest.mark.parametrize("seed", range(5))
def test_the_widest_passage_is_the_widest_there_is(seed):
    grid = clutter(seed)
    field = clearance_field(grid)
    roomy = np.argwhere(field >= R + 0.1)
    planner = skeleton(widest=True)
    rng = np.random.default_rng(seed)
    for a, b in rng.integers(len(roomy), size=(12, 2)):
        start, goal = tuple(roomy[a]), tuple(roomy[b])
        best = slow_widest(field, start, goal)
        poses = [Pose2(*grid.center_of(*cell), 0.0) for cell in (start, goal)]
        try:
            path = planner.plan(grid, *poses, R)
        except NoPath:
            assert best < R
            continue
        points, _ = points_along(path, 0.01)
        assert exact_clearance(grid, points).min() >= best - 0.002


def frontier_cells(cells):
    unknown = np.pad(cells == UNKNOWN, 1)
    beside = unknown[2:, 1:-1] | unknown[:-2, 1:-1] | unknown[1:-1, 2:] | unknown[1:-1, :-2]
    return np.argwhere((cells == FREE) & beside)


@pytest.mark.parametrize("seed", range(4))
def test_a_goal_at_a_frontier_is_met_uphill_within_the_tolerance(seed):
    rng = np.random.default_rng(seed)
    grid = clutter(seed)
    squared = feature_transform(grid.cells).squared
    field = clearance_field(grid)
    top = np.unravel_index(field.argmax(), field.shape)
    start = Pose2(*grid.center_of(*top), 0.0)
    pieces, _ = label(field >= R)
    planner = skeleton(goal_tolerance=0.4)
    met = 0
    for cell in rng.permutation(frontier_cells(grid.cells))[:60]:
        goal = Pose2(*grid.center_of(*cell), 1.0)
        try:
            path = planner.plan(grid, start, goal, R)
        except NoPath:
            continue
        except GoalBlocked:
            summit = steepest(squared, *cell)
            apart = math.hypot(*(np.array(summit) - cell)) * grid.resolution_m
            assert field[summit] < R or apart > 0.4 or pieces[summit] != pieces[top]
            continue
        met += 1
        assert path.goal.distance_to(goal) <= 0.4
        assert path.goal.yaw_rad == 1.0
        end = grid.cell_of(path.goal.x, path.goal.y)
        assert field[end] >= max(R, field[tuple(cell)])
    assert met > 5


def steepest(squared, row, col):
    """Uphill until the robot fits, slowly: always to the clearest of the eight neighbours over free floor."""
    while squared[row, col] < (R / 0.05 + 0.5 - 1e-6) ** 2:
        around = [
            (int(squared[r, c]), -k, (r, c))
            for k, (r, c) in enumerate((row + dr, col + dc) for dr in (-1, 0, 1) for dc in (-1, 0, 1))
            if 0 <= r < squared.shape[0] and 0 <= c < squared.shape[1]
            if squared[row, c] > 0 and squared[r, col] > 0
        ]
        best = max(around)
        if best[0] <= squared[row, col]:
            break
        row, col = best[2]
    return (row, col)
