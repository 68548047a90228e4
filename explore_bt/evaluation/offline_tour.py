"""What exploring could cost at best: a short watchman tour with the whole map known.

A watchman tour is a way from which a given share of the floor is seen (Chin and Ntafos, 1986); the shortest
one is NP-hard to find. What is found here is a tour that can be driven, so its length is an **upper bound**
of the optimum, and an explorer's path over it is at most the true ratio. Steps:

1. lookouts on a lattice, with what each sees (:class:`Lookouts`);
2. greedy set cover (Chvátal, 1979), as a way grows: the lookout that shows most for the detour it costs;
3. order by 2-opt and Or-opt; lookouts whose floor is seen in passing are dropped;
4. large neighbourhood search (Shaw, 1998): some stops near one another are taken out, the gap is filled as
   in 2 and 3, and the shorter tour is kept;
5. the tour is pulled straight on the grid and measured as a trial is: the metres driven until the share is
   seen, looking about every 0.1 m.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from explore_bt.evaluation.lookouts import Lookouts, look_from
from explore_bt.evaluation.visiting_order import shorter_order
from explore_bt.evaluation.watch import Watch

__all__ = ["KnownFloor", "Tour", "lookouts_of", "search_order", "watchman_tours"]

_LOOK_M = 0.1
_DETOUR_FLOOR_M = 0.3
_SPARE_SHARE = 0.002


@dataclass(frozen=True, slots=True, eq=False)
class KnownFloor:
    """A map as only the bound knows it: (rows, cols) bool masks over the same cells.

    Attributes:
        free: where sight goes through.
        wanted: the floor to be seen.
        reachable: where the robot can be.
        resolution_m: metres per cell.
    """

    free: NDArray[np.bool_]
    wanted: NDArray[np.bool_]
    reachable: NDArray[np.bool_]
    resolution_m: float


@dataclass(frozen=True, slots=True, eq=False)
class Tour:
    """A drivable tour.

    Attributes:
        share: of the floor that is seen at its end, as asked for.
        length_m: metres driven until then.
        corners: (N, 2) int64 rows and columns, the start first; the tour is straight between them.
    """

    share: float
    length_m: float
    corners: NDArray[np.int64]


def watchman_tours(
    known: KnownFloor,
    start_cell: tuple[int, int],
    range_m: float,
    shares: Sequence[float] = (0.9, 0.95, 0.99),
    *,
    rounds: int = 150,
    seed: int = 0,
) -> tuple[Tour, ...]:
    """A short tour for each share of the floor.

    Args:
        known: the map.
        start_cell: (row, col); the nearest reachable cell is taken.
        range_m: the lidar's.
        shares: of the floor to be seen.
        rounds: of the neighbourhood search for each share.
        seed: of the search.

    Returns:
        One tour a share, in their order; lengths rise with the share. A share that no lookout can reach
        has length inf.
    """
    lookouts = lookouts_of(known, start_cell, range_m)
    rng = np.random.default_rng(seed)
    curves = []
    order = [0]
    for share in sorted(shares):
        order = search_order(lookouts, min(share + _SPARE_SHARE, 1.0), rounds, rng, order)
        corners = lookouts.drive(order)
        curves.append((corners, _seen_along(known, corners, range_m)))
    return tuple(_best(curves, share) for share in shares)


def lookouts_of(known: KnownFloor, start_cell: tuple[int, int], range_m: float) -> Lookouts:
    """The places of a floor; the start is the reachable cell nearest to the one given."""
    places = np.argwhere(known.reachable)
    row, col = places[int(np.argmin(((places - np.asarray(start_cell)) ** 2).sum(axis=1)))].tolist()
    return Lookouts(known.free, known.wanted, known.reachable, (row, col), range_m, known.resolution_m)


def search_order(
    lookouts: Lookouts, share: float, rounds: int, rng: np.random.Generator, order: Sequence[int] = (0,)
) -> list[int]:
    """The stops of a short tour that sees a share of all targets, if any tour can.

    Args:
        lookouts: the places.
        share: of the targets.
        rounds: of the neighbourhood search.
        rng: for the search.
        order: stops to begin with; place 0 comes first.
    """
    search = _Search(lookouts, math.ceil(share * lookouts.target_count - 1e-9), list(order))
    search.mend()
    best, best_m = search.order, search.length_m
    for _ in range(rounds):
        if len(best) < 3:
            break
        search.order = _without_some(lookouts, best, rng)
        search.mend()
        if search.length_m < best_m - 1e-9 and search.is_enough:
            best, best_m = search.order, search.length_m
    return best


class _Search:
    """One order of stops, and the steps that change it."""

    def __init__(self, lookouts: Lookouts, wanted: int, order: list[int]) -> None:
        self._lookouts = lookouts
        self._wanted = wanted
        self._watch = Watch(lookouts)
        self._useful = np.arange(len(lookouts.cells), dtype=np.int64)
        self._useful = self._useful[np.isfinite(lookouts.distances_m(0))]
        self.order = order

    @property
    def is_enough(self) -> bool:
        self._watch.follow(self.order)
        return self._watch.count >= self._wanted

    @property
    def length_m(self) -> float:
        return sum(float(self._lookouts.distances_m(a)[b]) for a, b in itertools.pairwise(self.order))

    def mend(self) -> None:
        """Add stops until enough is seen, then order them, drop what is not needed, and shift the rest."""
        while not self.is_enough and self._add_best():
            pass
        self._reorder()
        while not self.is_enough and self._add_best():  # another order passes other places
            pass
        self._drop()
        self._shift()
        self._drop()

    def _add_best(self) -> bool:
        """Put in the place that shows most for its detour; False if none shows anything."""
        gains = np.minimum(self._watch.gains(self._useful), self._wanted - self._watch.count)
        ways = np.array([self._lookouts.distances_m(stop)[self._useful] for stop in self.order])
        detours = (
            ways[:-1]
            + ways[1:]
            - np.array(
                [[self._lookouts.distances_m(a)[b]] for a, b in itertools.pairwise(self.order)]
            ).reshape(-1, 1)
        )
        detours = np.concatenate((detours, ways[-1:]))  # or at the end
        value = gains / (detours.min(axis=0) + _DETOUR_FLOOR_M)
        best = int(np.argmax(value))
        if gains[best] <= 0:
            return False
        at = int(np.argmin(detours[:, best]))
        self.order = [*self.order[: at + 1], int(self._useful[best]), *self.order[at + 1 :]]
        return True

    def _reorder(self) -> None:
        distance = np.array([self._lookouts.distances_m(stop)[self.order] for stop in self.order])
        better = shorter_order(distance, np.arange(len(self.order), dtype=np.int64))
        self.order = [self.order[i] for i in better.tolist()]

    def _drop(self) -> None:
        """Leave out stops, the costliest first, as long as enough is seen without."""
        for stop in sorted(self.order[1:], key=self._saving_without, reverse=True):
            self._keep_if_enough([other for other in self.order if other != stop])

    def _saving_without(self, stop: int) -> float:
        i = self.order.index(stop)
        before, after = self._lookouts.distances_m(self.order[i - 1]), self.order[i + 1 : i + 2]
        if not after:
            return float(before[stop])
        return float(before[stop] + self._lookouts.distances_m(stop)[after[0]] - before[after[0]])

    def _shift(self) -> None:
        """Move each stop to a nearby place that shortens the tour most and still sees enough."""
        for i in range(1, len(self.order)):
            here = self.order[i]
            cost = self._lookouts.distances_m(self.order[i - 1]).copy()
            if i + 1 < len(self.order):
                cost += self._lookouts.distances_m(self.order[i + 1])
            around = np.argsort(self._lookouts.distances_m(here), kind="stable")[1:13]
            for place in around[np.argsort(cost[around], kind="stable")].tolist():
                if cost[place] >= cost[here] - 1e-9:
                    break
                if self._keep_if_enough([*self.order[:i], place, *self.order[i + 1 :]]):
                    break

    def _keep_if_enough(self, order: list[int]) -> bool:
        kept = self.order
        self.order = order
        if self.is_enough:
            return True
        self.order = kept
        return False


def _without_some(lookouts: Lookouts, order: list[int], rng: np.random.Generator) -> list[int]:
    """The order without some stops that lie near a random one."""
    middle = order[int(rng.integers(1, len(order)))]
    most = max(2, min(12, len(order) // 3))
    near = sorted(order[1:], key=lambda stop: float(lookouts.distances_m(middle)[stop]))
    gone = set(near[: int(rng.integers(1, most + 1))])
    return [stop for stop in order if stop not in gone]


def _seen_along(known: KnownFloor, corners: NDArray[np.int64], range_m: float) -> NDArray[np.float64]:
    """(M, 2): metres driven and share of the floor seen, looking about every 0.1 m."""
    number = np.full(known.wanted.shape, -1, dtype=np.int32)
    number[known.wanted] = np.arange(np.count_nonzero(known.wanted), dtype=np.int32)
    steps = np.diff(corners, axis=0)
    lengths_m = np.hypot(steps[:, 0], steps[:, 1]) * known.resolution_m
    along_m = np.concatenate(([0.0], np.cumsum(lengths_m)))
    at_m = np.append(np.arange(0.0, along_m[-1], _LOOK_M), along_m[-1])
    places = np.column_stack([np.interp(at_m, along_m, corners[:, axis]) for axis in range(2)])
    seen = np.zeros(np.count_nonzero(known.wanted), dtype=np.bool_)
    shares = []
    starts, targets = look_from(
        known.free, number, np.rint(places).astype(np.int64), range_m / known.resolution_m
    )
    for begin, end in itertools.pairwise(starts.tolist()):
        seen[targets[begin:end]] = True
        shares.append(np.count_nonzero(seen) / max(len(seen), 1))
    return np.column_stack((at_m, shares))


def _best(curves: Sequence[tuple[NDArray[np.int64], NDArray[np.float64]]], share: float) -> Tour:
    """Of all tours the one that sees the share first."""
    lengths = [
        float(curve[int(np.argmax(curve[:, 1] >= share)), 0]) if curve[-1, 1] >= share else math.inf
        for _, curve in curves
    ]
    first = int(np.argmin(lengths))
    return Tour(share, lengths[first], curves[first][0])
