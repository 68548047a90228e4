"""Where trials on a map begin."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from explore_bt.errors import WorldError
from explore_bt.exploration import clearance_field, travel_field
from explore_bt.types import OccupancyGrid, Pose2

__all__ = ["spread_starts"]

_COMFORT_M = 0.3
_CANDIDATES = 300


def spread_starts(floor: OccupancyGrid, radius_m: float, count: int, seed: int) -> tuple[Pose2, ...]:
    """Poses far from one another in the largest part of a floor that the footprint can roam.

    The first is the widest of some hundred places drawn at random, each next one is farthest by way from all
    before (Gonzalez, 1985); all have 0.3 m more clearance than r, or half the floor's widest if that is less.

    Args:
        floor: the true floor, all else solid.
        radius_m: r, with whatever is to spare.
        count: how many.
        seed: of places and headings; the first starts of a longer list are those of a shorter one.

    Raises:
        WorldError: the footprint fits nowhere.
    """
    clearance_m = clearance_field(floor)
    labels, parts = ndimage.label(clearance_m >= radius_m)
    if parts == 0:
        raise WorldError(
            f"no place of the floor is wide enough for a radius of {radius_m:g} m: make it smaller"
        )
    largest = labels == 1 + int(np.argmax(np.bincount(labels.ravel())[1:]))
    widest_m = float(clearance_m[largest].max())
    roomy = largest & (clearance_m >= min(radius_m + _COMFORT_M, 0.5 * (radius_m + widest_m)))
    rng = np.random.default_rng(seed)
    cells = np.argwhere(roomy)
    cells = cells[rng.permutation(len(cells))[:_CANDIDATES]]
    chosen = [int(np.argmax(clearance_m[cells[:, 0], cells[:, 1]]))]
    away_m = np.full(len(cells), np.inf)
    while len(chosen) < min(count, len(cells)):
        away_m = np.minimum(away_m, _ways_from(floor, clearance_m, cells[chosen[-1]], radius_m, cells))
        chosen.append(int(np.argmax(away_m)))
    yaws = rng.uniform(-math.pi, math.pi, len(chosen))
    places = floor.centers_of(cells[chosen])
    return tuple(Pose2(float(x), float(y), float(yaw)) for (x, y), yaw in zip(places, yaws, strict=True))


def _ways_from(
    floor: OccupancyGrid,
    clearance_m: NDArray[np.float32],
    start: NDArray[np.int64],
    radius_m: float,
    cells: NDArray[np.int64],
) -> NDArray[np.float64]:
    travel_m = travel_field(clearance_m, start, radius_m, floor.resolution_m)
    ways = travel_m[cells[:, 0], cells[:, 1]].astype(np.float64)
    return np.where(np.isfinite(ways), ways, -1.0)
