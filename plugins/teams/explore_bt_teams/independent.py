"""Allocator ``independent``: every robot explores as if it were alone, in the map of all."""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar

from explore_bt.interfaces import API_VERSION, Allocator, Offers

__all__ = ["Independent"]


class Independent(Allocator):
    """A baseline (Yamauchi, 1998): the map is shared, the plans are not."""

    name = "independent"
    api_version = API_VERSION
    heeds_claims: ClassVar[bool] = False

    def allot(self, offers: Offers) -> Sequence[int]:
        """All places."""
        return range(len(offers.gains_m2))
