"""Contract of allocators: which of the places worth a look are whose."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from explore_bt.interfaces.plugin import Plugin

__all__ = ["Allocator", "Offers"]


@dataclass(frozen=True, slots=True, eq=False)
class Offers:
    """N places that nobody has claimed, and R robots; the first is the one that asks.

    Attributes:
        names: (R,) of the robots.
        gains_m2: (N,) float64: what each place shows.
        between_m: (N, N) float64: ways between the places.
        from_robots_m: (R, N) float64: ways to them from where each robot will be free: where it stands,
            or its claim.
        committed_m: (R,) float64: the way to that claim; 0 for who has none, the asker among them.
        kept: (N,) bool: places that the asker is on its way to.
    """

    names: tuple[str, ...]
    gains_m2: NDArray[np.float64]
    between_m: NDArray[np.float64]
    from_robots_m: NDArray[np.float64]
    committed_m: NDArray[np.float64]
    kept: NDArray[np.bool_]


class Allocator(Plugin):
    """Divides the work; every robot asks its own, and nobody waits for anybody's answer.

    Attributes:
        heeds_claims: False: the asker does not mind what others are on their way to see.
    """

    kind = "allocator"
    heeds_claims: ClassVar[bool] = True

    @abstractmethod
    def allot(self, offers: Offers) -> Sequence[int]:
        """Which places are the asker's, as indices; it visits them in the order of a short tour.

        The same offers give the same answer. None: what is left is better left to the others.
        """
