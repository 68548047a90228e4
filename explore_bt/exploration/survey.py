"""The best place to see a frontier from."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from explore_bt.exploration.frontier import Frontier
from explore_bt.exploration.gain import gain_many
from explore_bt.exploration.sight import Sights, sights_of
from explore_bt.exploration.viewpoint import LeftOpen, Viewpoint
from explore_bt.types import OccupancyGrid, wrap_angle

__all__ = ["Survey"]

_FIRST_TRIES = 4


@dataclass(frozen=True, slots=True, eq=False)
class Survey:
    """What every frontier is judged by; for the attributes see :func:`choose_viewpoints`."""

    grid: OccupancyGrid
    travel_m: NDArray[np.float32]
    range_m: float
    depth_m: float
    min_gain_m2: float
    decay_per_m: float

    def sights(self, frontier: Frontier, places: NDArray[np.int64]) -> Sights:
        """Those of the places that see a frontier, and beyond it as far as an opening is believed.

        From farther off the lidar's range ends at the frontier: that it shows nothing tells nothing.
        """
        depth_m = self.depth_m if self.depth_m < 0.5 * self.range_m else 0.0
        return sights_of(self.grid, places, frontier.cells, self.range_m - depth_m)

    def answer(self, frontier: Frontier, places: NDArray[np.int64]) -> Viewpoint | LeftOpen | None:
        """The best of the places, or that they show too little; None where none sees the frontier."""
        sights = self.sights(frontier, places)
        return self._judge(frontier, sights) if len(sights.places) else None

    def _judge(self, frontier: Frontier, sights: Sights) -> Viewpoint | LeftOpen:
        """The best of the places that see a frontier (at least one), if what it shows is worth a drive.

        Utility is gain · exp(−λ travel) (González-Baños & Latombe, 2002). Places are tried in the order of
        what they would show if nothing stood behind the frontier; all are tried before it is given up.
        """
        travel = self.travel_m[tuple(sights.places.T)].astype(np.float64)
        near = np.minimum(sights.distance_m, self.range_m)
        band = np.minimum(near + self.depth_m, self.range_m) ** 2 - near**2
        discount = np.exp(-self.decay_per_m * travel)
        order = np.argsort(-sights.width_rad * band * discount, kind="stable")
        most, begin, count = 0.0, 0, _FIRST_TRIES
        while begin < order.size:
            chosen = order[begin : begin + count]
            gain = self._gain(sights, chosen)
            useful = gain >= self.min_gain_m2
            if useful.any():
                best = int(np.argmax(np.where(useful, gain * discount[chosen], -1.0)))
                return self._viewpoint(frontier, sights, int(chosen[best]), float(gain[best]))
            most, begin, count = max(most, float(gain.max())), begin + count, 2 * count
        return LeftOpen(frontier, f"shows only {most:.2f} m² of new area", is_closed=True)

    def _gain(self, sights: Sights, chosen: NDArray[np.intp]) -> NDArray[np.float64]:
        return gain_many(
            self.grid,
            self.grid.centers_of(sights.places[chosen]),
            self.range_m,
            fov_rad=sights.width_rad[chosen],
            heading_rad=sights.heading_rad[chosen],
            depth_m=self.depth_m,
        )

    def _viewpoint(self, frontier: Frontier, sights: Sights, at: int, gain_m2: float) -> Viewpoint:
        row, col = sights.places[at].tolist()
        return Viewpoint(
            xy=self.grid.center_of(row, col),
            heading_rad=wrap_angle(float(sights.heading_rad[at])),
            travel_m=float(self.travel_m[row, col]),
            gain_m2=gain_m2,
            frontier=frontier,
        )
