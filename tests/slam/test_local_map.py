from __future__ import annotations

import numpy as np
from explore_bt_slam.local_map import trusted_neighbours
from hypothesis import given
from hypothesis import strategies as st


@given(st.integers(0, 39))
def test_where_nothing_is_sure_only_keyframes_of_the_same_time_count(source: int) -> None:
    poses = np.zeros((40, 3))
    unsure = np.tile(np.eye(3), (40, 1, 1))
    chosen = trusted_neighbours(poses, unsure, source, 6.0, 0.07)
    assert chosen == [k for k in range(40) if abs(k - source) < 12]


def test_what_is_surely_placed_counts_whenever_it_was_seen_but_not_from_afar() -> None:
    poses = np.zeros((40, 3))
    poses[:20, 0] = 100.0
    sure = np.tile(np.eye(3) * 1e-6, (40, 1, 1))
    assert trusted_neighbours(poses, sure, 39, 6.0, 0.07) == list(range(20, 40))
