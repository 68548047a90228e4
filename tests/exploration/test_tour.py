from __future__ import annotations

from itertools import pairwise, permutations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from explore_bt.exploration import open_tour


def distances(seed: int, count: int) -> np.ndarray:
    points = np.random.default_rng(seed).uniform(0.0, 10.0, (count, 2))
    return np.hypot(*(points[:, None] - points[None]).transpose(2, 0, 1))


def length(order: np.ndarray, between: np.ndarray) -> float:
    return float(sum(between[a, b] for a, b in pairwise(order.tolist())))


@settings(deadline=None)  # compiles
@given(st.integers(0, 10_000), st.integers(1, 9), st.sampled_from([0.0, 1.0, 5.0]))
def test_a_tour_visits_every_place_once_and_begins_at_the_first(seed: int, count: int, haste: float) -> None:
    order = open_tour(distances(seed, count), haste=haste)
    assert order[0] == 0
    assert sorted(order) == list(range(count))


def test_tours_are_within_some_percent_of_the_best_of_all_orders() -> None:
    excess = []
    for seed in range(60):
        between = distances(seed, 7)
        best = min(length(np.array([0, *rest]), between) for rest in permutations(range(1, 7)))
        excess.append(length(open_tour(between), between) / best)
    assert min(excess) >= 1.0 - 1e-9
    assert np.mean(excess) < 1.02


def test_haste_goes_first_to_what_weighs_more() -> None:
    between = np.abs(np.subtract.outer([0.0, -1.0, 1.2], [0.0, -1.0, 1.2]))  # left, right of the robot
    assert open_tour(between).tolist() == [0, 1, 2]
    assert open_tour(between, np.array([0.0, 0.1, 10.0]), haste=5.0).tolist() == [0, 2, 1]
