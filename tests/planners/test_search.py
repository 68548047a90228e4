from itertools import pairwise

import numpy as np
import pytest
from explore_bt_planners.bottleneck import widest_squared
from explore_bt_planners.feature_transform import feature_transform
from explore_bt_planners.sampling import STEP_CELLS, clearances_at, segment_is_clear
from explore_bt_planners.search import ClearancePrice, find_costs, find_route
from scipy.sparse import coo_array
from scipy.sparse.csgraph import dijkstra

from explore_bt.errors import Cancelled
from explore_bt.interfaces import never
from explore_bt.types import OCCUPIED

FLAT = ClearancePrice(0.0, 0.0, 0.0)


def random_mask(seed, shape=(40, 50), share=0.3):
    mask = np.random.default_rng(seed).random(shape) > share
    mask[0, 0] = mask[-1, -1] = True
    return mask


TIMED = ClearancePrice(1.0, 3.0, 0.0, 1.5)


def price(clearance, wanted):
    if wanted.slow_m:
        return 1.0 / np.clip(1.0 - (wanted.comfortable_m - clearance) / wanted.slow_m, 0.2, 1.0)
    share = np.clip(
        (wanted.comfortable_m - clearance) / max(wanted.comfortable_m - wanted.floor_m, 1e-9), 0, None
    )
    return 1.0 + wanted.weight * share**2


def dijkstra_cost(mask, clearance, wanted, start, goal):
    """Independent: every edge listed, scipy does the rest."""
    rows, cols = mask.shape
    costs = price(clearance, wanted)
    ends, weights = [], []
    for r, c in np.argwhere(mask):
        for dr, dc in ((0, 1), (1, 0), (1, 1), (1, -1)):
            nr, nc = r + dr, c + dc
            if not (0 <= nr < rows and 0 <= nc < cols and mask[nr, nc]):
                continue
            if dr and dc and not (mask[r, nc] and mask[nr, c]):
                continue
            ends.append((r * cols + c, nr * cols + nc))
            weights.append(np.hypot(dr, dc) * 0.5 * (costs[r, c] + costs[nr, nc]))
    graph = coo_array((weights, np.array(ends).T), shape=(mask.size, mask.size)).tocsr()
    return dijkstra(graph, directed=False, indices=start[0] * cols + start[1])[goal[0] * cols + goal[1]]


def route_cost(route, clearance, wanted):
    steps = np.hypot(*np.diff(route, axis=0).T)
    costs = price(clearance, wanted)[route[:, 0], route[:, 1]]
    return float((steps * 0.5 * (costs[1:] + costs[:-1])).sum())


@pytest.mark.parametrize("seed", range(12))
@pytest.mark.parametrize("wanted", [FLAT, ClearancePrice(1.0, 3.0, 2.0), TIMED])
def test_a_route_is_as_short_as_dijkstra_s(seed, wanted):
    mask = random_mask(seed, share=0.15 + 0.02 * seed)
    clearance = np.random.default_rng(seed).uniform(1.0, 4.0, mask.shape).astype(np.float32)
    route = find_route(mask, mask, clearance, wanted, (0, 0), (39, 49), never)
    best = dijkstra_cost(mask, clearance.astype(float), wanted, (0, 0), (39, 49))
    assert (route is None) == np.isinf(best)
    if route is not None:
        assert route_cost(route, clearance.astype(float), wanted) == pytest.approx(best, rel=1e-6)


@pytest.mark.parametrize("seed", range(3))
def test_the_costs_of_many_goals_are_dijkstra_s(seed):
    mask = random_mask(seed, shape=(20, 25), share=0.3)
    clearance = np.random.default_rng(seed).uniform(1.0, 4.0, mask.shape).astype(np.float32)
    goals = np.argwhere(np.ones_like(mask))[::7]
    wanted = ClearancePrice(1.0, 3.0, 2.0)
    found = find_costs(mask, mask, clearance, wanted, (0, 0), goals, never)
    best = [dijkstra_cost(mask, clearance.astype(float), wanted, (0, 0), tuple(goal)) for goal in goals]
    assert found == pytest.approx(np.array(best), rel=1e-6)


@pytest.mark.parametrize("seed", range(6))
def test_a_route_steps_over_passable_cells_only(seed):
    mask = random_mask(seed, share=0.2)
    route = find_route(mask, mask, np.ones(mask.shape, np.float32), FLAT, (0, 0), (39, 49), never)
    if route is None:
        return
    assert mask[route[:, 0], route[:, 1]].all()
    steps = np.diff(route, axis=0)
    assert np.abs(steps).max() == 1
    for (r0, c0), (r1, c1) in pairwise(route):
        assert mask[r0, c1]
        assert mask[r1, c0]


def test_a_thin_diagonal_is_walked_through_the_passable_cell_beside_it():
    passable = np.zeros((4, 4), dtype=bool)
    passable[[0, 0, 1, 1, 2, 2, 3], [0, 1, 1, 2, 2, 3, 3]] = True
    diagonal = np.eye(4, dtype=bool)
    route = find_route(diagonal, passable, np.ones((4, 4), np.float32), FLAT, (0, 0), (3, 3), never)
    assert route is not None
    assert route.tolist() == [[0, 0], [0, 1], [1, 1], [1, 2], [2, 2], [2, 3], [3, 3]]


def test_a_search_over_many_cells_asks_now_and_then_and_gives_up():
    mask = np.ones((400, 400), dtype=bool)
    mask[200, :399] = False
    asked = []

    def cancelled():
        asked.append(1)
        return len(asked) > 5

    with pytest.raises(Cancelled):
        find_route(mask, mask, np.ones(mask.shape, np.float32), FLAT, (0, 0), (399, 0), cancelled)
    assert len(asked) == 6


@pytest.mark.parametrize("seed", range(6))
def test_the_widest_way_is_the_one_found_by_trying_every_width(seed):
    rng = np.random.default_rng(seed)
    cells = np.where(rng.random((40, 40)) < 0.08, OCCUPIED, 0).astype(np.int8)
    cells[2, 2] = cells[37, 37] = 0
    squared = feature_transform(cells).squared
    from scipy.ndimage import label

    best = 0
    for level in np.unique(squared[squared > 0]):
        pieces, _ = label(squared >= level)
        if pieces[2, 2] and pieces[2, 2] == pieces[37, 37]:
            best = int(level)
    assert widest_squared(squared, (2, 2), (37, 37)) == best


@pytest.mark.parametrize("seed", range(4))
def test_a_segment_is_clear_where_every_sample_of_it_is(seed):
    rng = np.random.default_rng(seed)
    cells = np.where(rng.random((70, 90)) < 0.004, OCCUPIED, 0).astype(np.int8)
    squared = feature_transform(cells).squared
    clearance = (0.05 * np.maximum(np.sqrt(squared) - 0.5, 0.0)).astype(np.float32)
    clear = []
    for u0, v0, u1, v1 in rng.uniform(0.0, (90.0, 70.0, 90.0, 70.0), size=(300, 4)):
        floor = float(rng.choice([0.1, 0.25, 0.4]))
        count = max(1, int(np.ceil(np.hypot(u1 - u0, v1 - v0) / STEP_CELLS)))
        t = np.arange(count + 1) / count
        values = clearances_at(clearance, np.column_stack((u0 + t * (u1 - u0), v0 + t * (v1 - v0))))
        clear.append(bool((values >= floor).all()))
        assert segment_is_clear(clearance, u0, v0, u1, v1, floor, 0.05) == clear[-1]
    assert 10 < sum(clear) < 290
