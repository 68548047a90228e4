"""Allocator ``greedy``: the nearest place that nobody has claimed."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from explore_bt.interfaces import API_VERSION, Allocator, Offers

__all__ = ["Greedy"]


class Greedy(Allocator):
    """A baseline: no look at where the others are, none ahead of the next place."""

    name = "greedy"
    api_version = API_VERSION

    def allot(self, offers: Offers) -> Sequence[int]:
        """The nearest."""
        return [int(np.argmin(offers.from_robots_m[0]))] if len(offers.gains_m2) else []
