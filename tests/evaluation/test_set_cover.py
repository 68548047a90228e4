import itertools
import math

import numpy as np
import pytest

from explore_bt.evaluation.lookouts import Lookouts
from explore_bt.evaluation.offline_tour import search_order
from explore_bt.evaluation.set_cover import cover, set_cover_tour_m


def random_floor(seed):
    free = np.random.default_rng(seed).random((24, 24)) < 0.85
    free[:3] = free[:, :3] = True
    return Lookouts(free, free, free, (0, 0), 0.8, 0.1, 0.4)


def seen_by(lookouts, places):
    views = [lookouts.seen[lookouts.starts[p] : lookouts.starts[p + 1]].tolist() for p in places]
    return set().union(*views)


@pytest.mark.parametrize("seed", range(6))
def test_a_cover_sees_what_was_asked_for_and_no_place_of_it_is_superfluous(seed):
    lookouts = random_floor(seed)
    near = np.flatnonzero(np.isfinite(lookouts.distances_m(0))).tolist()
    wanted = math.ceil(0.9 * len(seen_by(lookouts, near)))
    chosen = cover(lookouts, wanted / lookouts.target_count)
    assert chosen[0] == 0
    assert len(seen_by(lookouts, chosen)) >= wanted
    for place in chosen[1:]:
        assert len(seen_by(lookouts, [other for other in chosen if other != place])) < wanted


@pytest.mark.parametrize("seed", range(4))
def test_the_textbook_tour_is_not_shorter_than_the_one_that_sees_in_passing(seed):
    lookouts = random_floor(seed)
    near = np.flatnonzero(np.isfinite(lookouts.distances_m(0))).tolist()
    share = 0.9 * len(seen_by(lookouts, near)) / lookouts.target_count
    order = search_order(lookouts, share, 40, np.random.default_rng(0))
    better_m = sum(lookouts.distances_m(a)[b] for a, b in itertools.pairwise(order))
    assert set_cover_tour_m(lookouts, share) >= better_m - 1e-9


def test_a_share_that_nobody_can_see_has_no_tour():
    free = np.zeros((9, 9), dtype=bool)
    free[:3] = free[6:] = True
    lookouts = Lookouts(free, free, free, (0, 0), 5.0, 0.1)
    assert set_cover_tour_m(lookouts, 0.99) == math.inf
    assert set_cover_tour_m(lookouts, 0.5) == 0.0
