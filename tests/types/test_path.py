from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from explore_bt.types import Path, way_along

_PLACES = st.lists(st.tuples(*[st.floats(-100.0, 100.0)] * 3), min_size=1, max_size=20)


@given(_PLACES)
def test_the_way_grows_by_each_step_and_ends_at_the_length(places: list[tuple[float, float, float]]) -> None:
    poses = np.array(places)
    expected = [0.0]
    for (x0, y0, _), (x1, y1, _) in pairwise(places):
        expected.append(expected[-1] + math.hypot(x1 - x0, y1 - y0))
    assert np.allclose(way_along(poses), expected)
    assert math.isclose(Path(poses, np.ones(len(poses))).length_m, expected[-1], abs_tol=1e-9)


def test_no_point_no_way() -> None:
    assert way_along(np.zeros((0, 3))).size == 0
