"""What the robot knows about its neighbourhood, for those who act on it at once."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from explore_bt.types import MovingObstacle, OccupancyGrid

__all__ = ["Surroundings"]


@dataclass(frozen=True, slots=True, eq=False)
class Surroundings:
    """Renewed with every scan; everything in the ``map`` frame.

    Attributes:
        stamp_s: of the scan.
        points: (N, 2) float64, metres: its returns, also those of moving things.
        grid: the newest map; places that are out of the lidar's sight are known to it alone.
        moving: what moves nearby.
        hidden: (K, 2) float64, metres: the edge of where someone may stand unseen; none while nobody
            is about.
    """

    stamp_s: float
    points: NDArray[np.float64]
    grid: OccupancyGrid
    moving: tuple[MovingObstacle, ...] = ()
    hidden: NDArray[np.float64] = field(default_factory=lambda: np.empty((0, 2)))
