import heapq
import itertools
import math

import numpy as np
import pytest

from explore_bt.evaluation.lookouts import Lookouts
from explore_bt.evaluation.offline_tour import KnownFloor, search_order, watchman_tours

ROOMS = """
############
#....#.....#
#....#.....#
#..........#
#....#.....#
####.#######
#..........#
#.####..#..#
#....#..#..#
############
"""
COMB = """
#############
#...........#
#.#.#.#.#.#.#
#.#.#.#.#.#.#
#.#.#.#.#.#.#
#############
"""
OPEN = """
########
#......#
#......#
#......#
########
"""


def known(text, cells_per_mark=4):
    marks = np.array([list(line) for line in text.strip().splitlines()])
    free = np.kron(marks == ".", np.ones((cells_per_mark, cells_per_mark), dtype=bool))
    reachable = free.copy()
    for axis in (0, 1):
        for shift in (-1, 1):
            reachable &= np.roll(free, shift, axis)
    return KnownFloor(free, free, reachable, 0.1)


def lookouts_of(floor, start, range_m, spacing_m):
    return Lookouts(floor.free, floor.wanted, floor.reachable, start, range_m, 0.1, spacing_m)


def optimum_m(lookouts, wanted):
    """The shortest walk on the lattice from which so many targets are seen: Dijkstra over what is seen."""
    views = [
        sum(1 << int(t) for t in lookouts.seen[lookouts.starts[i] : lookouts.starts[i + 1]])
        for i in range(len(lookouts.cells))
    ]
    graph = lookouts.graph
    queue, best = [(0.0, 0, views[0])], {(0, views[0]): 0.0}
    while queue:
        length, place, seen = heapq.heappop(queue)
        if length > best[place, seen]:
            continue
        if seen.bit_count() >= wanted:
            return length
        for k in range(graph.indptr[place], graph.indptr[place + 1]):
            there = int(graph.indices[k])
            state, further = (there, seen | views[there]), length + float(graph.data[k])
            if further < best.get(state, math.inf):
                best[state] = further
                heapq.heappush(queue, (further, *state))
    return math.inf


@pytest.mark.parametrize("share", [0.7, 0.9, 0.95, 1.0])
@pytest.mark.parametrize(
    ("text", "start", "range_m"),
    [(ROOMS, (6, 6), 1.5), (ROOMS, (26, 40), 3.0), (COMB, (6, 6), 2.0), (OPEN, (6, 6), 0.8)],
    ids=["rooms", "rooms from afar", "comb", "hall"],
)
def test_a_tour_is_within_three_percent_of_the_shortest_there_is(text, start, range_m, share):
    lookouts = lookouts_of(known(text), start, range_m, 0.8)
    seeable = len(np.unique(lookouts.seen))
    wanted = min(math.ceil(share * lookouts.target_count - 1e-9), seeable)
    best_m = optimum_m(lookouts, wanted)
    order = search_order(lookouts, wanted / lookouts.target_count, 60, np.random.default_rng(0))
    length_m = sum(lookouts.distances_m(a)[b] for a, b in itertools.pairwise(order))
    assert best_m - 1e-9 <= length_m <= 1.03 * best_m + 1e-9
    passed = [place for a, b in itertools.pairwise(order) for place in lookouts.way(a, b)] or [0]
    views = [lookouts.seen[lookouts.starts[i] : lookouts.starts[i + 1]] for i in passed]
    assert len(np.unique(np.concatenate(views))) >= wanted


def test_every_corner_of_a_tour_is_reachable_and_so_is_every_line_between():
    floor = known(ROOMS)
    for tour in watchman_tours(floor, (6, 6), 1.5, rounds=10):
        assert tour.corners[0].tolist() == [6, 6]
        for a, b in itertools.pairwise(tour.corners):
            line = np.rint(np.linspace(a, b, 60)).astype(int)
            assert floor.reachable[line[:, 0], line[:, 1]].all()


def test_lengths_rise_with_the_share_and_a_hopeless_share_has_none():
    floor = known(ROOMS)
    lengths = [tour.length_m for tour in watchman_tours(floor, (6, 6), 1.5, (0.5, 0.9, 0.99), rounds=10)]
    assert lengths == sorted(lengths)
    assert math.isfinite(lengths[-1])
    wall = ~floor.free
    hopeless = KnownFloor(floor.free, floor.free | wall, floor.reachable, 0.1)
    assert watchman_tours(hopeless, (6, 6), 1.5, (1.0,), rounds=2)[0].length_m == math.inf


def test_the_same_seed_gives_the_same_tour():
    floor = known(COMB)
    one, other = (watchman_tours(floor, (6, 6), 2.0, (0.95,), rounds=20, seed=3)[0] for _ in range(2))
    assert np.array_equal(one.corners, other.corners)


def test_who_sees_everything_from_the_start_need_not_move():
    assert watchman_tours(known(OPEN), (9, 16), 9.0, (0.99,), rounds=5)[0].length_m == 0.0


def test_the_way_between_two_places_is_not_much_longer_than_a_straight_line_and_never_shorter():
    lookouts = lookouts_of(known(OPEN), (6, 6), 1.0, 0.2)
    ways = lookouts.distances_m(0)
    crow = 0.1 * np.hypot(*(lookouts.cells - lookouts.cells[0]).T)
    assert (ways >= crow - 1e-6).all()
    assert (ways <= 1.04 * crow + 0.05).all()


def test_places_that_no_straight_line_joins_are_joined_round_the_corner():
    marks = np.zeros((20, 20), dtype=bool)
    marks[2, 2:18] = marks[2:18, 17] = marks[17, 4:18] = True
    lookouts = Lookouts(marks, marks, marks, (2, 2), 1.0, 0.1, 0.8)
    assert np.isfinite(lookouts.distances_m(0)).all()
    corners = [cell.tolist() for cell in lookouts.drive([0, len(lookouts.cells) - 1])]
    assert corners[:2] == [[2, 2], [2, 17]]
