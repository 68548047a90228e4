"""Why no place the robot can go to sees a frontier."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from explore_bt.exploration.frontier import Frontier
from explore_bt.exploration.passage import passage_field
from explore_bt.exploration.places import best_places
from explore_bt.exploration.survey import Survey
from explore_bt.exploration.viewpoint import LeftOpen, Viewpoint

__all__ = ["Unseen"]


class Unseen:
    """A closer look at frontiers that no place of the first, thin set sees."""

    def __init__(
        self,
        survey: Survey,
        clearance_m: NDArray[np.float32],
        score: NDArray[np.float32],
        fresh: NDArray[np.float32],
        radius_m: float,
        thin_cells: int,
        dense_cells: int,
    ) -> None:
        """Prepares the sets of places.

        Args:
            survey: what frontiers are judged by.
            clearance_m: (rows, cols) float32, metres.
            score: (rows, cols) float32, above zero where the robot can go.
            fresh: the same without what was tried in vain.
            radius_m: r, the footprint.
            thin_cells: side of the blocks that one place stands for behind a passage.
            dense_cells: the same where the robot can go.
        """
        self._survey = survey
        self._radius_m = radius_m
        self._passage_m = passage_field(clearance_m, survey.travel_m, radius_m)
        self._fresh = best_places(fresh, dense_cells)
        self._tried = best_places(np.where(fresh > 0.0, np.float32(0.0), score), dense_cells)
        self._behind = best_places(np.where(score > 0.0, np.float32(0.0), self._passage_m), thin_cells)

    def answer(self, frontier: Frontier) -> Viewpoint | LeftOpen:
        """A viewpoint after all, or in words what keeps the robot from every one."""
        if not (self._passage_m[tuple(frontier.cells.T)] > 0.0).any():  # sight runs over connected floor
            return LeftOpen(frontier, "no reachable place sees it")
        found = self._survey.answer(frontier, self._fresh)
        return LeftOpen(frontier, self._why(frontier)) if found is None else found

    def _why(self, frontier: Frontier) -> str:
        if len(self._survey.sights(frontier, self._tried).places):
            return "every place that sees it was tried"
        places = self._survey.sights(frontier, self._behind).places
        if len(places) == 0:
            return "no reachable place sees it"
        widest_m = float(self._passage_m[tuple(places.T)].max())
        return (
            f"too narrow by {math.ceil((self._radius_m - widest_m) * 100 - 1e-6)} cm: "
            f"passage clearance {widest_m:.2f} m, needs {self._radius_m:.2f} m"
        )
