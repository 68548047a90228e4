"""The incremental transform and everything derived from it, against making all of it anew."""

from dataclasses import replace

import numpy as np
import pytest
from explore_bt_planners.feature_transform import feature_transform
from explore_bt_planners.terrain import Terrain
from explore_bt_planners.terrain_cache import TerrainCache
from explore_bt_planners.transform_update import changed_window, update_transform
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.ndimage import distance_transform_edt

from explore_bt.types import FREE, OCCUPIED, UNKNOWN, GridWindow, OccupancyGrid

R = 0.25
KINDS = [FREE, FREE, OCCUPIED, UNKNOWN]
FIELDS = ("clearance_m", "passable", "skeleton", "component")


def building(rng, rows, cols):
    """Rooms, unknown patches and speckle."""
    cells = np.full((rows, cols), FREE, dtype=np.int8)
    cells[:: max(rows // 3, 2)] = OCCUPIED
    for _ in range(rows * cols // 400):
        r, c = rng.integers(0, rows), rng.integers(0, cols)
        cells[r : r + rng.integers(1, 14), c : c + rng.integers(1, 14)] = rng.choice(KINDS)
    cells[rng.random(cells.shape) < 0.002] = OCCUPIED
    return cells


def redrawn(rng, cells):
    """The same cells but for a window that is opened, closed, seen or sprinkled."""
    rows, cols = cells.shape
    row, col = rng.integers(0, rows), rng.integers(0, cols)
    window = (slice(row, row + rng.integers(1, rows + 1)), slice(col, col + rng.integers(1, cols + 1)))
    new = cells.copy()
    how = rng.integers(4)
    if how < 3:
        new[window] = (FREE, OCCUPIED, UNKNOWN)[how]
    part = rng.random(new[window].shape) < rng.choice([0.0, 0.01, 0.3])
    new[window][part] = rng.choice(KINDS)
    return new


def slow_window(old, new):
    where = np.argwhere((old == FREE) != (new == FREE))
    return (*where.min(axis=0), *(where.max(axis=0) + 1))


def brute_force(cells):
    """Squared distance and nearest obstacle of every free cell, by looking at all of them."""
    padded = np.pad(cells != FREE, 1, constant_values=True)
    padded[[0, 0, -1, -1], [0, -1, 0, -1]] = False  # never nearer than the sides
    sites = np.argwhere(padded) - 1
    sites = sites[np.lexsort((sites[:, 0], sites[:, 1]))]
    free = np.argwhere(cells == FREE)
    squared = ((free[:, None, :] - sites[None]) ** 2).sum(axis=2)
    return free, squared.min(axis=1), sites[squared.argmin(axis=1)]


def assert_same(one, other):
    assert np.array_equal(one.squared, other.squared)
    assert np.array_equal(one.row, other.row)
    assert np.array_equal(one.col, other.col)


@settings(deadline=None, max_examples=50)
@given(st.integers(0, 2**32), st.integers(1, 90), st.integers(1, 90))
def test_an_updated_transform_is_bit_equal_to_a_full_one(seed, rows, cols):
    rng = np.random.default_rng(seed)
    cells = building(rng, rows, cols)
    transform = feature_transform(cells)
    for _ in range(4):
        new = redrawn(rng, cells)
        window, count = changed_window(cells, new, GridWindow(0, 0, rows, cols))
        assert count == ((cells == FREE) != (new == FREE)).sum()
        if count:
            assert (window.row0, window.col0, window.row1, window.col1) == slow_window(cells, new)
            update_transform(transform, new, window)
        assert_same(transform, feature_transform(new))
        cells = new


@pytest.mark.parametrize("seed", range(6))
def test_an_updated_transform_equals_brute_force_and_scipy(seed):
    rng = np.random.default_rng(seed)
    cells = building(rng, 45, 60)
    transform = feature_transform(cells)
    for _ in range(3):
        new = redrawn(rng, cells)
        window, count = changed_window(cells, new, GridWindow(0, 0, 45, 60))
        if count:
            update_transform(transform, new, window)
        cells = new
    free, squared, sites = brute_force(cells)
    at = (free[:, 0], free[:, 1])
    assert np.array_equal(transform.squared[at], squared)
    assert np.array_equal(np.column_stack((transform.row[at], transform.col[at])), sites)
    distance = distance_transform_edt(np.pad(cells == FREE, 1))[1:-1, 1:-1]
    assert np.array_equal(transform.squared, np.rint(distance**2))


def test_a_change_far_from_a_cell_leaves_it_untouched():
    cells = np.zeros((300, 300), dtype=np.int8)
    cells[::20], cells[:, ::20] = OCCUPIED, OCCUPIED
    transform = feature_transform(cells)
    new = cells.copy()
    new[105:108, 145:150] = OCCUPIED
    touched = update_transform(transform, new, GridWindow(105, 145, 108, 150))
    assert touched.row1 - touched.row0 < 60
    assert touched.col1 - touched.col0 < 60
    assert_same(transform, feature_transform(new))


def require_fresh(cache, grid, threshold_m):
    kept = cache.terrain(grid, threshold_m)
    fresh = Terrain(grid, threshold_m, 1.7, feature_transform(np.ascontiguousarray(grid.cells)))
    for field in FIELDS:
        assert np.array_equal(getattr(kept, field), getattr(fresh, field)), field
    assert kept.grid is grid


@settings(deadline=None, max_examples=40)
@given(st.integers(0, 2**32))
def test_terrains_kept_over_changes_and_growth_are_bit_equal_to_fresh_ones(seed):
    rng = np.random.default_rng(seed)
    cache, cells, origin = TerrainCache(1.7), building(rng, 70, 80), np.array([-1.0, 2.0])
    for revision in range(8):
        if rng.random() < 0.4:
            low, high = rng.integers(0, 25, size=(2, 2))
            cells = np.pad(cells, ((low[0], high[0]), (low[1], high[1])), constant_values=UNKNOWN)
            origin = origin - low[::-1] * 0.05
        if rng.random() < 0.8:
            cells = redrawn(rng, cells)
        grid = OccupancyGrid(cells.copy(), 0.05, (float(origin[0]), float(origin[1])), revision)
        for threshold_m in rng.choice([R, R + 0.02, 0.1], size=rng.integers(1, 3), replace=False):
            require_fresh(cache, grid, float(threshold_m))


def test_a_growing_map_is_the_same_map_and_a_foreign_one_is_not():
    cells = building(np.random.default_rng(3), 80, 80)
    cache = TerrainCache(1.7)
    require_fresh(cache, OccupancyGrid(cells, 0.05, (0.0, 0.0), 1), R)
    grown = OccupancyGrid(np.pad(cells, 10, constant_values=UNKNOWN), 0.05, (-0.5, -0.5), 2)
    require_fresh(cache, grown, R)
    assert cache.lineage == 1
    foreign = building(np.random.default_rng(4), 100, 100)
    foreign[30:90] = np.where(grown.cells[30:90] == FREE, OCCUPIED, FREE)
    others = (
        replace(grown, cells=foreign),
        OccupancyGrid(foreign, 0.1, (-0.5, -0.5), 3),
        OccupancyGrid(foreign, 0.1, (-0.52, -0.5), 4),
        OccupancyGrid(cells.copy(), 0.1, (-0.52, -0.5), 5),
    )
    for number, grid in enumerate(others, start=2):
        require_fresh(cache, grid, R)
        assert cache.lineage == (number if number < 3 else cache.lineage)
    assert cache.lineage >= 4


def test_a_word_on_where_the_map_changed_holds_for_these_two_maps_only():
    rng = np.random.default_rng(8)
    first = OccupancyGrid(building(rng, 90, 90), 0.05, (0.0, 0.0), 1)
    cells = first.cells.copy()
    cells[20:30, 40:44] = OCCUPIED
    second = OccupancyGrid(cells, 0.05, (0.0, 0.0), 2)
    elsewhere = first.cells.copy()
    elsewhere[70:80, 10:20] = OCCUPIED
    foreign = OccupancyGrid(elsewhere, 0.05, (0.0, 0.0), 2)
    for given_map in (second, foreign):
        cache = TerrainCache(1.7)
        require_fresh(cache, first, R)
        cache.expect(first, second, GridWindow(20, 40, 30, 44))
        require_fresh(cache, given_map, R)
