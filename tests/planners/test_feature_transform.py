import numpy as np
import pytest
from explore_bt_planners.feature_transform import feature_transform
from explore_bt_planners.medial_axis import medial_axis
from explore_bt_planners.terrain import Terrain
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from explore_bt.exploration.clearance import clearance_field
from explore_bt.types import FREE, OCCUPIED, UNKNOWN, OccupancyGrid

CELLS = arrays(
    np.int8,
    st.tuples(st.integers(1, 14), st.integers(1, 14)),
    elements=st.sampled_from([FREE, FREE, FREE, FREE, OCCUPIED, UNKNOWN]),
)


def slow_transform(cells):
    """Squared distance, and row and column of the nearest obstacle; ties to the lowest column, then row."""
    padded = np.pad(cells != FREE, 1, constant_values=True)
    padded[0, 0] = padded[0, -1] = padded[-1, 0] = padded[-1, -1] = False  # never nearer than the edges
    sites = np.argwhere(padded) - 1
    sites = sites[np.lexsort((sites[:, 0], sites[:, 1]))]
    result = np.zeros((3, *cells.shape), dtype=np.int64)
    for r, c in np.ndindex(*cells.shape):
        squared = ((sites - (r, c)) ** 2).sum(axis=1)
        nearest = int(squared.argmin())
        result[:, r, c] = squared[nearest], *sites[nearest]
    return result


def slow_axis(squared, row, col, min_squared, separation):
    axis = np.zeros(squared.shape, dtype=bool)
    rows, cols = squared.shape
    for r, c in np.ndindex(rows, cols):
        for nr, nc in ((r + 1, c), (r - 1, c), (r, c + 1), (r, c - 1)):
            if 0 <= nr < rows and 0 <= nc < cols and squared[nr, nc] <= squared[r, c]:
                apart = np.hypot(row[nr, nc] - row[r, c], col[nr, nc] - col[r, c])
                axis[r, c] |= apart >= separation and squared[r, c] >= min_squared
    return axis


@settings(deadline=None, max_examples=150)
@given(CELLS)
def test_the_transform_equals_the_search_through_all_obstacles_ties_included(cells):
    fast, slow = feature_transform(cells), slow_transform(cells)
    assert np.array_equal(fast.squared, slow[0])
    assert np.array_equal(fast.col, slow[2])
    assert np.array_equal(fast.row, slow[1])


def test_a_large_sparse_map_is_transformed_exactly():
    rng = np.random.default_rng(3)
    cells = np.where(rng.random((60, 80)) < 0.01, OCCUPIED, FREE).astype(np.int8)
    fast, slow = feature_transform(cells), slow_transform(cells)
    assert np.array_equal(np.stack((fast.squared, fast.row, fast.col)), slow)


@settings(deadline=None, max_examples=60)
@given(CELLS, st.sampled_from([1, 2, 4]), st.sampled_from([2.0, 3.0]))
def test_the_medial_axis_equals_its_definition(cells, min_squared, separation):
    transform = feature_transform(cells)
    fast = medial_axis(transform, min_squared, separation)
    slow = slow_axis(transform.squared, transform.row, transform.col, min_squared, separation)
    assert np.array_equal(fast, slow)


@settings(deadline=None, max_examples=40)
@given(CELLS, st.sampled_from([0.05, 0.1]))
def test_clearance_is_the_framework_s(cells, resolution):
    grid = OccupancyGrid(cells, resolution, (0.0, 0.0))
    terrain = Terrain(grid, 0.25, 1.7, feature_transform(cells))
    assert np.allclose(terrain.clearance_m, clearance_field(grid), atol=1e-5)
    assert np.array_equal(terrain.passable, clearance_field(grid) >= 0.25 - 1e-5)


@pytest.mark.parametrize("seed", range(8))
def test_the_skeleton_joins_whatever_passable_space_joins(seed):
    rng = np.random.default_rng(seed)
    cells = np.zeros((120, 120), dtype=np.int8)
    for r, c in rng.integers(0, 115, size=(45, 2)):
        cells[r : r + rng.integers(1, 12), c : c + rng.integers(1, 12)] = rng.choice([OCCUPIED, UNKNOWN])
    grid = OccupancyGrid(cells, 0.05, (0.0, 0.0))
    terrain = Terrain(grid, 0.2, 1.7, feature_transform(cells))
    from scipy.ndimage import label

    pieces, count = label(terrain.skeleton, structure=np.ones((3, 3)))
    homes = [int(terrain.component[tuple(np.argwhere(pieces == k)[0])]) for k in range(1, count + 1)]
    assert len(set(homes)) == len(homes), "a piece of free space holds two pieces of skeleton"
