"""Travel distance from the robot to every place it can reach."""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from explore_bt.exploration.arguments import require_at_least, require_positive
from explore_bt.exploration.escape import escape_distances

__all__ = ["nearest_reaching_cell", "travel_field"]

_DIAGONAL = math.sqrt(2.0)


@njit(cache=True)
def _relax(distance, factor, weighted, buckets, filled, here, there, length):  # type: ignore[no-untyped-def]  # numba kernel
    """Shorten the way to ``there`` by the step from ``here``, and queue it when its bucket changes."""
    if weighted:
        length *= 0.5 * (factor[here] + factor[there])
    old, new = distance[there], distance[here] + length
    if new < old:
        distance[there] = new
        level = int(new)
        if old == math.inf or int(old) != level:
            bucket = level % filled.size
            buckets[bucket, filled[bucket]] = there
            filled[bucket] += 1


@njit(cache=True)
def _spread(passable, factor, weighted, width, seeds, distance, bucket_count):  # type: ignore[no-untyped-def]  # numba kernel
    """Shortest distances in cells over a padded, flattened mask; ``distance`` holds those of the seeds.

    Buckets one cell wide: no step is shorter, so every cell in the lowest bucket is settled, in whatever
    order it is taken (Dial, 1969; Dinic, 1978).
    """
    buckets = np.empty((bucket_count, passable.size), dtype=np.int32)
    filled = np.zeros(bucket_count, dtype=np.int64)
    level, waiting = 0, seeds.size
    by_level = np.argsort(distance[seeds], kind="mergesort")
    due = 0
    while due < waiting or filled.any():
        while due < waiting and int(distance[seeds[by_level[due]]]) <= level:
            bucket = level % bucket_count
            buckets[bucket, filled[bucket]] = seeds[by_level[due]]
            filled[bucket] += 1
            due += 1
        bucket = level % bucket_count
        for i in range(filled[bucket]):
            here = buckets[bucket, i]
            if int(distance[here]) != level:
                continue
            up, down = passable[here + width], passable[here - width]
            left, right = passable[here - 1], passable[here + 1]
            for open_, there in ((left, here - 1), (right, here + 1), (down, here - width), (up, here + width)):
                if open_:
                    _relax(distance, factor, weighted, buckets, filled, here, there, 1.0)
            for open_, there in (
                (up and left, here + width - 1),
                (up and right, here + width + 1),
                (down and left, here - width - 1),
                (down and right, here - width + 1),
            ):
                if open_ and passable[there]:
                    _relax(distance, factor, weighted, buckets, filled, here, there, _DIAGONAL)
        filled[bucket] = 0
        level += 1
