import itertools

import numpy as np
import pytest

from explore_bt.evaluation.visiting_order import shorter_order


def length_of(distance, order):
    return sum(distance[a, b] for a, b in itertools.pairwise(order))


@pytest.mark.parametrize("seed", range(40))
def test_the_order_is_near_the_best_of_all_and_keeps_beginning_and_places(seed):
    rng = np.random.default_rng(seed)
    points = rng.uniform(0.0, 10.0, (7, 2))
    distance = np.hypot(*(points[:, None] - points[None]).transpose(2, 0, 1))
    order = shorter_order(distance, np.arange(7))
    best = min(length_of(distance, (0, *rest)) for rest in itertools.permutations(range(1, 7)))
    assert order[0] == 0
    assert sorted(order.tolist()) == list(range(7))
    assert length_of(distance, order) <= min(1.15 * best, length_of(distance, range(7)) + 1e-9)


@pytest.mark.parametrize("count", [1, 2, 3])
def test_few_places_are_no_trouble(count):
    distance = np.abs(np.subtract.outer([0.0, 5.0, 1.0], [0.0, 5.0, 1.0]))
    assert shorter_order(distance, np.arange(count)).tolist() == [[0], [0, 1], [0, 2, 1]][count - 1]
