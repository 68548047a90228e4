"""The textbook bound: fewest viewpoints by greedy set cover, then a travelling-salesman order.

What others compare with, so that figures can be told beside theirs. It counts what is seen from the
viewpoints alone and knows nothing of what is seen in passing; the tours of
:mod:`explore_bt.evaluation.offline_tour` are shorter.
"""

from __future__ import annotations

import itertools
import math

import numpy as np
from numpy.typing import NDArray

from explore_bt.evaluation.lookouts import Lookouts
from explore_bt.evaluation.visiting_order import shorter_order

__all__ = ["cover", "set_cover_tour_m"]


def cover(lookouts: Lookouts, share: float) -> list[int]:
    """Places that together see a share of the targets, the start among them (Chvátal, 1979), then pruned.

    Args:
        lookouts: the places; number 0 is the start and sees for nothing.
        share: of the targets; if no places can see it, those that see all they can.
    """
    wanted = math.ceil(share * lookouts.target_count - 1e-9)
    views = [view.astype(np.int64) for view in np.split(lookouts.seen, lookouts.starts[1:-1])]
    near = np.flatnonzero(np.isfinite(lookouts.distances_m(0)))
    times = np.zeros(lookouts.target_count, dtype=np.int64)
    times[views[0]] += 1
    chosen, gains = [0], {int(place): len(views[place]) for place in near[1:].tolist()}
    while np.count_nonzero(times) < wanted and gains:
        place = _most(gains, views, times)
        if place is None:
            break
        chosen.append(place)
        times[views[place]] += 1
    for place in sorted(chosen[1:], key=lambda place: len(views[place])):
        times[views[place]] -= 1
        if np.count_nonzero(times) >= wanted:
            chosen.remove(place)
        else:
            times[views[place]] += 1
    return chosen


def set_cover_tour_m(lookouts: Lookouts, share: float) -> float:
    """Length of an open tour from the start through a cover; inf if no places see that share."""
    chosen = cover(lookouts, share)
    views = [lookouts.seen[lookouts.starts[place] : lookouts.starts[place + 1]] for place in chosen]
    seen = np.unique(np.concatenate(views))
    if len(seen) < math.ceil(share * lookouts.target_count - 1e-9):
        return math.inf
    distance = np.array([lookouts.distances_m(place)[chosen] for place in chosen])
    order = shorter_order(distance, _nearest_first(distance))
    return float(sum(distance[a, b] for a, b in itertools.pairwise(order.tolist())))


def _most(gains: dict[int, int], views: list[NDArray[np.int64]], times: NDArray[np.int64]) -> int | None:
    """The place that adds most. What it would have added before bounds what it adds now (Minoux, 1978)."""
    best, best_gain = None, 0
    for place, bound in sorted(gains.items(), key=lambda item: -item[1]):
        if bound <= best_gain:
            break
        gains[place] = int(np.count_nonzero(times[views[place]] == 0))
        if gains[place] > best_gain:
            best, best_gain = place, gains[place]
    return best


def _nearest_first(distance: NDArray[np.float64]) -> NDArray[np.int64]:
    """From each place to the nearest one not yet visited."""
    order, left = [0], set(range(1, len(distance)))
    while left:
        order.append(min(left, key=lambda place: (distance[order[-1], place], place)))
        left.remove(order[-1])
    return np.array(order, dtype=np.int64)
