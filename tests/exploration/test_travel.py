import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from scipy.sparse import coo_array
from scipy.sparse.csgraph import dijkstra

from explore_bt.errors import UserError
from explore_bt.exploration import clearance_field, nearest_reaching_cell, travel_field
from explore_bt.exploration.travel import Travel

from .grids import drawn

fields = hnp.arrays(
    np.float32,
    st.tuples(st.integers(1, 12), st.integers(1, 12)),
    elements=st.sampled_from([0.0, 0.1, 0.2, 0.3, 0.4, 0.6]).map(np.float32),
)


def by_scipy(clearance, start, radius_m, weight=0.0, comfort_m=0.6):
    rows, cols = clearance.shape
    fits = (clearance >= radius_m) & (clearance > 0)
    cost = 1 + weight * (1 - np.minimum(clearance.astype(float) / comfort_m, 1))
    edges = []
    for r, c in np.argwhere(fits).tolist():
        for i in (-1, 0, 1):
            for j in (-1, 0, 1):
                there = (r + i, c + j)
                inside = 0 <= there[0] < rows and 0 <= there[1] < cols
                if (i or j) and inside and fits[there] and fits[r + i, c] and fits[r, c + j]:
                    length = math.hypot(i, j) * (cost[r, c] + cost[there]) / 2
                    edges.append((r * cols + c, there[0] * cols + there[1], length))
    a, b, lengths = zip(*edges, strict=True) if edges else ((), (), ())
    graph = coo_array((lengths, (a, b)), shape=(rows * cols, rows * cols)).tocsr()
    return dijkstra(graph, indices=start[0] * cols + start[1]).reshape(rows, cols)


@settings(deadline=None, max_examples=80)
@given(fields, st.data(), st.sampled_from([0.0, 0.2, 0.3]), st.sampled_from([0.0, 0.7, 4.0]))
def test_travel_is_what_scipys_dijkstra_finds(clearance, data, radius_m, weight):
    fitting = np.argwhere((clearance >= np.float32(radius_m)) & (clearance > 0))
    if len(fitting) == 0:
        return
    start = tuple(fitting[data.draw(st.integers(0, len(fitting) - 1))])
    expected = by_scipy(clearance, start, np.float32(radius_m), weight)
    found = travel_field(clearance, start, radius_m, 0.05, clearance_weight=weight)
    np.testing.assert_allclose(found, 0.05 * expected, rtol=1e-5)


@settings(deadline=None, max_examples=80)
@given(fields, st.lists(st.tuples(st.integers(-2, 12), st.integers(-2, 12)), min_size=1, max_size=3))
def test_reached_is_where_a_way_leads(clearance, starts):
    travel = Travel(clearance, 0.2, 0.1)
    np.testing.assert_array_equal(
        travel.reached(np.array(starts)), np.isfinite(travel.field(np.array(starts)))
    )


@settings(deadline=None, max_examples=40)
@given(fields, st.lists(st.tuples(st.integers(-2, 12), st.integers(-2, 12)), min_size=1, max_size=3))
def test_several_starts_give_the_nearest_of_them(clearance, starts):
    alone = [travel_field(clearance, start, 0.2, 0.1) for start in starts]
    together = travel_field(clearance, np.array(starts), 0.2, 0.1)
    np.testing.assert_allclose(together, np.min(alone, axis=0), rtol=1e-6)


def climbs_out(clearance, start, radius_m, reach):
    """Shortest lengths of all ways out on which clearance never falls, by plain relaxation."""
    best, ends, queue = {start: 0.0}, {}, [start]
    while queue:
        cell = queue.pop(0)
        if clearance[cell] >= radius_m:
            if clearance[cell] > 0:
                ends[cell] = best[cell]
            continue
        for i in (-1, 0, 1):
            for j in (-1, 0, 1):
                there = (cell[0] + i, cell[1] + j)
                if not (0 <= there[0] < clearance.shape[0] and 0 <= there[1] < clearance.shape[1]):
                    continue
                far = best[cell] + math.hypot(i, j)
                rises = clearance[there] > 0 and clearance[there] >= clearance[cell]
                if rises and far <= reach and far < best.get(there, math.inf):
                    best[there] = far
                    queue.append(there)
    return ends


@settings(deadline=None, max_examples=60)
@given(fields, st.data())
def test_a_tight_start_is_left_by_climbing_clearance(clearance, data):
    start = data.draw(st.tuples(*(st.integers(0, n - 1) for n in clearance.shape)))
    radius = np.float32(0.3)
    expected = np.full(clearance.shape, np.inf)
    for cell, length in climbs_out(clearance, start, radius, 6.0).items():
        expected = np.minimum(expected, length + by_scipy(clearance, cell, radius))
    expected[start] = 0.0
    found = travel_field(clearance, start, radius, 0.1, escape_m=0.6)
    np.testing.assert_allclose(found, 0.1 * expected, rtol=1e-5)


def test_a_robot_in_a_tight_corridor_comes_out_into_the_hall():
    grid = drawn("\n".join(["#" * 24] * 5 + ["#" * 6 + "." * 17 + "#"] * 12 + ["#" * 24]))
    cells = grid.cells.copy()
    cells[10:13, 2:6] = 0  # a niche 0.3 m wide
    niche = type(grid)(cells, 0.1, (0.0, 0.0))
    travel = travel_field(clearance_field(niche), (11, 3), 0.25, 0.1)
    assert travel[11, 3] == 0.0
    assert math.isfinite(travel[11, 18])
    assert math.isinf(travel[11, 2])
    closed = travel_field(clearance_field(niche), (11, 3), 0.25, 0.1, escape_m=0.1)
    assert np.isfinite(closed).sum() == 1


def test_corners_are_not_cut():
    clearance = np.array([[1, 0], [1, 1]], dtype=np.float32)
    assert travel_field(clearance, (0, 0), 0.5, 1.0)[1, 1] == pytest.approx(2.0)


@settings(deadline=None, max_examples=60)
@given(
    hnp.arrays(
        np.float32, st.tuples(st.integers(1, 9), st.integers(1, 9)), elements=st.sampled_from([1.0, np.inf])
    ),
    st.tuples(st.integers(-3, 11), st.integers(-3, 11)),
    st.sampled_from([0.0, 1.5, 4.0, math.inf]),
)
def test_the_nearest_reaching_cell_is_the_nearest(travel, cell, within):
    near = [
        (math.hypot(r - cell[0], c - cell[1]), (r, c))
        for r, c in np.argwhere(np.isfinite(travel)).tolist()
        if math.hypot(r - cell[0], c - cell[1]) <= within
    ]
    assert nearest_reaching_cell(travel, cell, within) == (min(near)[1] if near else None)


def test_a_resolution_of_nothing_is_refused():
    with pytest.raises(UserError, match="resolution_m: 0"):
        travel_field(np.ones((2, 2), np.float32), (0, 0), 0.1, 0.0)
