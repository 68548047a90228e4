"""How often each piece of floor is seen on a way through lookouts."""

from __future__ import annotations

import itertools

import numpy as np
from numba import njit
from numpy.typing import NDArray

from explore_bt.evaluation.lookouts import Lookouts

__all__ = ["Watch"]


@njit(cache=True)
def _see(times, starts, seen, places, sign):  # type: ignore[no-untyped-def]  # numba kernel
    """Add ``sign`` to the targets of each place; how many more are seen now."""
    more = 0
    for place in places:
        for k in range(starts[place], starts[place + 1]):
            before = times[seen[k]]
            times[seen[k]] = before + sign
            if sign > 0 and before == 0:
                more += 1
            elif sign < 0 and before == 1:
                more -= 1
    return more


@njit(cache=True)
def _gains(times, starts, seen, places):  # type: ignore[no-untyped-def]  # numba kernel
    """Targets that each place sees and nobody has seen."""
    gains = np.zeros(places.shape[0], dtype=np.int64)
    for i in range(places.shape[0]):
        for k in range(starts[places[i]], starts[places[i] + 1]):
            if times[seen[k]] == 0:
                gains[i] += 1
    return gains


class Watch:
    """Counts what is seen from stops and along the legs between them; legs come and go."""

    def __init__(self, lookouts: Lookouts) -> None:
        self._lookouts = lookouts
        self._times = np.zeros(lookouts.target_count, dtype=np.int32)
        self._order: list[int] = []
        self.count = 0

    def follow(self, order: list[int]) -> None:
        """Change to another order of stops; only legs that differ cost anything."""
        old, new = list(itertools.pairwise(self._order)), list(itertools.pairwise(order))
        head = 0
        while head < min(len(old), len(new)) and old[head] == new[head]:
            head += 1
        tail = 0
        while tail < min(len(old), len(new)) - head and old[-1 - tail] == new[-1 - tail]:
            tail += 1
        for leg in new[head : len(new) - tail]:
            self._see(self._lookouts.way(*leg), 1)
        for leg in old[head : len(old) - tail]:
            self._see(self._lookouts.way(*leg), -1)
        if not self._order:  # a way of no leg still stands at its first stop
            self._see(np.array(order[:1], dtype=np.int64), 1)
        self._order = list(order)

    def gains(self, places: NDArray[np.int64]) -> NDArray[np.int64]:
        """(N,): how many targets each of (N,) places would add."""
        return np.asarray(_gains(self._times, self._lookouts.starts, self._lookouts.seen, places))

    def _see(self, places: NDArray[np.int64], sign: int) -> None:
        self.count += int(_see(self._times, self._lookouts.starts, self._lookouts.seen, places, sign))
