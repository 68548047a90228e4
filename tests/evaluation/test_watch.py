import itertools

import numpy as np

from explore_bt.evaluation.lookouts import Lookouts
from explore_bt.evaluation.watch import Watch


def test_changing_orders_counts_what_a_fresh_count_would():
    rng = np.random.default_rng(0)
    free = rng.random((30, 30)) < 0.9
    free[:3] = free[:, :3] = True
    lookouts = Lookouts(free, free, free, (0, 0), 0.6, 0.1, 0.5)
    near = np.flatnonzero(np.isfinite(lookouts.distances_m(0))).tolist()
    watch = Watch(lookouts)
    for _ in range(60):
        order = [0, *rng.choice(near[1:], int(rng.integers(0, 7)), replace=False).tolist()]
        watch.follow(order)
        passed = [p for a, b in itertools.pairwise(order) for p in lookouts.way(a, b)] or [0]
        seen = {
            t for p in passed for t in lookouts.seen[lookouts.starts[p] : lookouts.starts[p + 1]].tolist()
        }
        assert watch.count == len(seen)
        gains = watch.gains(np.array(near[:5]))
        views = [set(lookouts.seen[lookouts.starts[p] : lookouts.starts[p + 1]].tolist()) for p in near[:5]]
        assert gains.tolist() == [len(view - seen) for view in views]
