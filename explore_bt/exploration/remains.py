"""What stays unexplored, and why: one sentence for each reason."""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from explore_bt.exploration.frontier import Frontier, find_frontiers
from explore_bt.exploration.passage import passage_field
from explore_bt.types import OccupancyGrid

__all__ = ["sentences", "what_remains"]

_AROUND_M = 1.0
_EIGHT = np.ones((3, 3), dtype=np.int8)


def what_remains(
    grid: OccupancyGrid,
    clearance_m: NDArray[np.float32],
    travel_m: NDArray[np.float32],
    radius_m: float,
    *,
    min_gain_m2: float = 0.1,
    min_size_m: float = 0.15,
) -> tuple[tuple[tuple[float, float], str], ...]:
    """Frontiers that still border on unknown area of some size though no place worth a drive shows it.

    Args:
        grid: the map.
        clearance_m: (rows, cols) float32, as from :func:`clearance_field`.
        travel_m: (rows, cols) float32, as from :func:`travel_field` for a footprint of ``radius_m``.
        radius_m: r, the footprint.
        min_gain_m2: smaller patches of unknown are of no use.
        min_size_m: smaller frontiers are leaks between beams.

    Returns:
        For each its middle (x, y, metres, ``map`` frame) and the reason. A frontier on floor that the robot
        can come to shows nothing from anywhere, and is left out.
    """
    patches, _ = ndimage.label(np.pad(grid.unknown, 1, constant_values=True), _EIGHT)
    area_m2 = np.bincount(patches.ravel()) * grid.resolution_m**2
    area_m2[0] = 0.0
    largest = ndimage.maximum_filter(area_m2[patches], size=3)[1:-1, 1:-1]
    frontiers = [
        frontier
        for frontier in find_frontiers(grid, min_size_m)
        if largest[tuple(frontier.cells.T)].max() >= min_gain_m2
    ]
    if not frontiers:
        return ()
    around = round(_AROUND_M / grid.resolution_m)
    passage_m = passage_field(clearance_m, travel_m, radius_m)
    room_m = np.where(clearance_m >= radius_m, passage_m, np.float32(0.0))
    found = (
        (frontier, _why(frontier, travel_m, passage_m, room_m, radius_m, around)) for frontier in frontiers
    )
    return tuple((frontier.centroid, why) for frontier, why in found if why)


def _why(
    frontier: Frontier,
    travel_m: NDArray[np.float32],
    passage_m: NDArray[np.float32],
    room_m: NDArray[np.float32],
    radius_m: float,
    around: int,
) -> str:
    """The reason is in the way to the nearest place beside the frontier with room for the robot."""
    if not (passage_m[tuple(frontier.cells.T)] > 0.0).any():
        return "no known floor leads there: behind glass, or seen through a gap"
    row, col = frontier.middle_cell
    low = (max(0, row - around), max(0, col - around))
    window = (slice(low[0], row + around + 1), slice(low[1], col + around + 1))
    places = np.argwhere(room_m[window] > 0.0) + low
    if len(places) == 0:
        widest_m = float(passage_m[window].max())
    else:
        nearest = tuple(places[np.argmin(((places - (row, col)) ** 2).sum(axis=1))])
        widest_m = float(room_m[nearest])
        if np.isfinite(travel_m[nearest]):
            return ""
    missing_cm = math.ceil((radius_m - widest_m) * 100 - 1e-6)
    return f"too narrow by {missing_cm} cm: passage clearance {widest_m:.2f} m, needs {radius_m:.2f} m"


def sentences(places: Iterable[tuple[tuple[float, float], str]]) -> tuple[str, ...]:
    """One sentence for each reason, with the first place and how many more there are."""
    at: dict[str, list[tuple[float, float]]] = {}
    for place, reason in places:
        at.setdefault(reason, []).append(place)
    return tuple(
        f"({found[0][0]:.1f}, {found[0][1]:.1f})"
        + (f" and {len(found) - 1} more" if len(found) > 1 else "")
        + f": {reason}"
        for reason, found in at.items()
    )
