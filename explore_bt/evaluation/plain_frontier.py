"""The baseline of every comparison: drive to the nearest frontier, and nothing else (Yamauchi, 1997)."""

from __future__ import annotations

import math
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from explore_bt.evaluation.straight import straightened
from explore_bt.exploration import clearance_field, find_frontiers, travel_field
from explore_bt.exploration.way_down import way_down
from explore_bt.types import OccupancyGrid, Path, Pose2

__all__ = ["PlainDecision", "PlainNearestFrontier"]

_SAME_PLACE_M = 0.15


@dataclass(frozen=True, slots=True)
class PlainDecision:
    """See :class:`explore_bt.evaluation.exploration_trial.Decision`."""

    goal: Pose2 | None = None
    path: Path | None = None
    done: bool = False
    outcome: str = ""
    reason: str = ""


class PlainNearestFrontier:
    """Goes to the nearest place that comes as near to a frontier as the footprint may; forgets at once.

    A place reached in vain (its frontier is still there) is not gone to again: else it would stand still.
    """

    def __init__(self, radius_m: float = 0.2, min_size_m: float = 0.3) -> None:
        """Args: r of the footprint, and the extent of the smallest frontier that is gone to, in metres."""
        self._radius_m = radius_m
        self._min_size_m = min_size_m
        self._in_vain: list[tuple[float, float]] = []

    def decide(self, grid: OccupancyGrid, pose: Pose2) -> PlainDecision:
        """The way to the nearest frontier, or done."""
        clearance_m = clearance_field(grid)
        travel_m = travel_field(clearance_m, grid.cell_of(*pose.xy), self._radius_m, grid.resolution_m)
        frontiers = find_frontiers(grid, self._min_size_m, off_walls=True)
        if not frontiers:
            return PlainDecision(done=True, outcome="explored", reason="no frontier is left")
        beside = self._beside(grid, np.concatenate([frontier.cells for frontier in frontiers]))
        while True:
            travel_to_m = np.where(beside, travel_m, np.inf)
            row, col = (int(i) for i in np.unravel_index(int(np.argmin(travel_to_m)), travel_m.shape))
            if not math.isfinite(travel_to_m[row, col]):
                return PlainDecision(done=True, outcome="explored", reason="no frontier can be reached")
            if travel_to_m[row, col] > _SAME_PLACE_M:
                break
            self._in_vain.append(grid.center_of(row, col))
            self._without(grid, beside, self._in_vain[-1])
        cells = straightened(way_down(travel_m, (row, col)), clearance_m >= self._radius_m)
        path = _path(grid, clearance_m, cells)
        return PlainDecision(goal=path.goal, path=path)

    def _beside(self, grid: OccupancyGrid, cells: NDArray[np.int64]) -> NDArray[np.bool_]:
        """Cells within r and two cells of a frontier, less those about places reached in vain."""
        far = np.ones(grid.shape, dtype=np.uint8)
        far[cells[:, 0], cells[:, 1]] = 0
        away = cv2.distanceTransform(far, cv2.DIST_L2, cv2.DIST_MASK_5)
        beside = np.asarray(away <= self._radius_m / grid.resolution_m + 2.0)
        for place in self._in_vain:
            self._without(grid, beside, place)
        return beside

    def _without(self, grid: OccupancyGrid, beside: NDArray[np.bool_], place: tuple[float, float]) -> None:
        row, col = grid.cell_of(*place)
        reach = math.ceil(2.0 * self._radius_m / grid.resolution_m)
        beside[max(row - reach, 0) : row + reach + 1, max(col - reach, 0) : col + reach + 1] = False


def _path(grid: OccupancyGrid, clearance_m: NDArray[np.float32], cells: NDArray[np.int64]) -> Path:
    xy = grid.centers_of(cells)
    steps = np.diff(xy, axis=0)
    yaw = np.arctan2(steps[:, 1], steps[:, 0])
    yaw = np.append(yaw, yaw[-1:]) if len(yaw) else np.zeros(1)
    room = clearance_m[cells[:, 0], cells[:, 1]].astype(np.float64)
    return Path(np.column_stack((xy, yaw)), room)
