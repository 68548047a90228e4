"""For every frontier the best place to see it from, or the reason why none is worth a drive."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import NDArray

from explore_bt.exploration.arguments import require_at_least, require_positive
from explore_bt.exploration.frontier import Frontier
from explore_bt.exploration.places import best_places
from explore_bt.exploration.survey import Survey
from explore_bt.exploration.unseen import Unseen
from explore_bt.exploration.viewpoint import LeftOpen, Viewpoint, ViewpointChoice
from explore_bt.types import OccupancyGrid

__all__ = ["choose_viewpoints"]

_THIN_M = 0.4
_DENSE_M = 0.1


def choose_viewpoints(
    grid: OccupancyGrid,
    clearance_m: NDArray[np.float32],
    travel_m: NDArray[np.float32],
    frontiers: Sequence[Frontier],
    range_m: float,
    *,
    radius_m: float,
    min_gain_m2: float = 0.1,
    depth_m: float = 1.0,
    decay_per_m: float = 0.2,
    tried: Iterable[tuple[float, float]] = (),
    tried_radius_m: float = 0.3,
) -> ViewpointChoice:
    """For every frontier the best place to see it from, or the reason why none is worth a drive.

    A place sees a frontier if one of its cells is in range and only free cells lie between. Of every
    block of 0.4 m the reachable cell with the most clearance stands for the rest.

    Args:
        grid: the map.
        clearance_m: (rows, cols) float32, as from :func:`clearance_field`.
        travel_m: (rows, cols) float32, as from :func:`travel_field`.
        frontiers: as from :func:`find_frontiers`.
        range_m: the lidar's range.
        radius_m: r that ``travel_m`` was made with; names what is missing at a passage.
        min_gain_m2: least new area that is worth a drive.
        depth_m: how far into the unknown an opening is believed; see :func:`gain_many`.
        decay_per_m: λ, how much a metre of travel takes off a gain.
        tried: places looked from in vain, x, y in metres; none is chosen within ``tried_radius_m``.
        tried_radius_m: see ``tried``.

    Raises:
        ArgumentError: if range or radius is not above zero, or another length is below zero.
    """
    require_positive(range_m=range_m, radius_m=radius_m)
    require_at_least(0, min_gain_m2=min_gain_m2, decay_per_m=decay_per_m, tried_radius_m=tried_radius_m)
    survey = Survey(grid, travel_m, range_m, depth_m, min_gain_m2, decay_per_m)
    score = np.where(np.isfinite(travel_m), clearance_m + np.float32(1e-6), np.float32(0.0))
    fresh = _without(grid, score, tried, tried_radius_m)
    thin, dense = (max(1, round(spacing_m / grid.resolution_m)) for spacing_m in (_THIN_M, _DENSE_M))
    places = best_places(fresh, thin)
    answers = [survey.answer(frontier, places) for frontier in frontiers]
    if None in answers:
        unseen = Unseen(survey, clearance_m, score, fresh, radius_m, thin, dense)
        answers = [
            unseen.answer(frontier) if answer is None else answer
            for frontier, answer in zip(frontiers, answers, strict=True)
        ]
    return ViewpointChoice(
        tuple(answer for answer in answers if isinstance(answer, Viewpoint)),
        tuple(answer for answer in answers if isinstance(answer, LeftOpen)),
    )


def _without(
    grid: OccupancyGrid, score: NDArray[np.float32], tried: Iterable[tuple[float, float]], radius_m: float
) -> NDArray[np.float32]:
    """The score with zero in a disc about each tried place."""
    fresh = score.copy()
    reach = math.ceil(radius_m / grid.resolution_m) + 1
    for x, y in tried:
        row, col = grid.cell_of(x, y)
        rows = np.arange(max(0, row - reach), max(0, min(grid.shape[0], row + reach + 1)))
        cols = np.arange(max(0, col - reach), max(0, min(grid.shape[1], col + reach + 1)))
        off_y = grid.origin_xy[1] + (rows + 0.5) * grid.resolution_m - y
        off_x = grid.origin_xy[0] + (cols + 0.5) * grid.resolution_m - x
        near = off_y[:, None] ** 2 + off_x[None, :] ** 2 <= radius_m**2
        fresh[np.ix_(rows, cols)] = np.where(near, np.float32(0.0), fresh[np.ix_(rows, cols)])
    return fresh
