import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from explore_bt.exploration import passage_field


def by_relaxation(clearance, reachable, radius):
    """max over ways of the least clearance, relaxed until nothing changes."""
    widest = np.where(reachable, radius, 0.0)
    while True:
        padded = np.pad(widest, 1)
        best = np.max([padded[:-2, 1:-1], padded[2:, 1:-1], padded[1:-1, :-2], padded[1:-1, 2:]], axis=0)
        after = np.maximum(widest, np.minimum(best, clearance))
        if np.array_equal(after, widest):
            return widest
        widest = after


@settings(deadline=None, max_examples=60)
@given(
    hnp.arrays(
        np.float32,
        st.tuples(st.integers(1, 12), st.integers(1, 12)),
        elements=st.sampled_from([0.0, 0.05, 0.1, 0.2, 0.25, 0.5]).map(np.float32),
    ),
    st.data(),
)
def test_the_passage_is_the_least_clearance_on_the_widest_way(clearance, data):
    radius = np.float32(0.28)
    roomy = np.argwhere(clearance >= radius)
    reachable = np.zeros(clearance.shape, dtype=bool)
    for i in data.draw(st.lists(st.integers(0, max(0, len(roomy) - 1)), max_size=3)) if len(roomy) else ():
        reachable[tuple(roomy[i])] = True
    travel = np.where(reachable, np.float32(1.0), np.float32(np.inf))
    expected = by_relaxation(clearance, reachable, radius)
    np.testing.assert_allclose(passage_field(clearance, travel, float(radius)), expected, atol=1e-3)
