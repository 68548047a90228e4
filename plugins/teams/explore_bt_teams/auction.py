"""Allocator ``auction``: places go one by one to the robot for whose tour they are the shortest detour."""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar

import numpy as np
from numba import njit
from pydantic import Field

from explore_bt.interfaces import API_VERSION, Allocator, Offers, PluginOptions
from explore_bt.units import Length

__all__ = ["Auction", "AuctionOptions"]


_LARGE_M2 = 5.0


class AuctionOptions(PluginOptions):
    """What a bid is made of."""

    evenness: float = Field(
        2.0,
        ge=0.0,
        le=100.0,
        description="0: the least way for all together; more: the earliest end for all",
    )
    follow_up: Length = Field(
        10.0,
        ge=0.0,
        le=100.0,
        description="further way that a place of 5 m² brings along; one that shows less brings less",
    )
    kept: float = Field(
        0.3, ge=0.1, le=1.0, description="what the way to a place counts for who is on its way to it"
    )


class Auction(Allocator):
    """A sequential single-item auction (Koenig et al., 2006) that every robot holds by itself.

    All know the same map, places and claims, so all come to nearly the same result; where they do not, the
    claim that is told first stands. A bid is what a place adds to the robot's tour at the best position in
    it, plus a share of how long that tour is then; the least bid over all places and robots wins, until all
    are given away. A place makes a tour longer by what is to be found behind it, too: else one robot is given
    every opening of a corridor, for what lies behind them is not known yet.
    """

    name = "auction"
    api_version = API_VERSION
    Options: ClassVar[type[PluginOptions]] = AuctionOptions

    def __init__(self, options: PluginOptions) -> None:
        super().__init__(options)
        self._settings = AuctionOptions.model_validate(options.model_dump())

    def allot(self, offers: Offers) -> Sequence[int]:
        """What the asker wins; ties go to the name that comes first."""
        if not len(offers.gains_m2):
            return []
        ranks = np.argsort(np.argsort(np.array(offers.names)))
        from_robots = np.array(offers.from_robots_m, dtype=np.float64)
        from_robots[0, offers.kept] *= self._settings.kept
        owners = _auction(
            from_robots,
            np.ascontiguousarray(offers.between_m, dtype=np.float64),
            offers.committed_m + self._settings.follow_up * (offers.committed_m > 0.0),
            self._settings.follow_up * np.minimum(offers.gains_m2 / _LARGE_M2, 1.0),
            ranks.astype(np.int64),
            self._settings.evenness,
        )
        return np.flatnonzero(owners == 0).tolist()


@njit(cache=True)
def _auction(from_robots, between, committed, behind, ranks, evenness):  # type: ignore[no-untyped-def]  # numba kernel
    """(N,) int64: to whom each place goes; see :class:`Auction`."""
    robots, places = from_robots.shape
    tours = np.zeros((robots, places), dtype=np.int64)
    counts = np.zeros(robots, dtype=np.int64)
    lengths = committed.copy()
    owners = np.full(places, -1, dtype=np.int64)
    for _ in range(places):
        best, best_more = np.inf, 0.0
        winner, item, position = -1, -1, -1
        for k in range(places):
            if owners[k] >= 0:
                continue
            for r in range(robots):
                more, at = _detour(from_robots[r], between, tours[r], counts[r], k)
                bid = more + evenness * (lengths[r] + more)
                is_tie = abs(bid - best) < 1e-6 and winner >= 0 and ranks[r] < ranks[winner]
                if bid < best - 1e-6 or is_tie:
                    best, best_more = bid, more
                    winner, item, position = r, k, at
        for i in range(counts[winner], position, -1):
            tours[winner, i] = tours[winner, i - 1]
        tours[winner, position] = item
        counts[winner] += 1
        lengths[winner] += best_more + behind[item]
        owners[item] = winner
    return owners


@njit(cache=True)
def _detour(from_robot, between, tour, count, k):  # type: ignore[no-untyped-def]  # numba kernel
    """What a place adds to an open tour at the best position, and that position."""
    if count == 0:
        return from_robot[k], 0
    best, at = between[tour[count - 1], k], count
    for i in range(count):
        into = from_robot[k] if i == 0 else between[tour[i - 1], k]
        past = from_robot[tour[0]] if i == 0 else between[tour[i - 1], tour[i]]
        more = into + between[k, tour[i]] - past
        if more < best:
            best, at = more, i
    return best, at
