"""What a lidar would measure in a map, for callers who have a map and a pose but no scan."""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from explore_bt.exploration.arguments import require_positive
from explore_bt.exploration.kernel_input import read_only
from explore_bt.exploration.ray_steps import ray_steps
from explore_bt.types import FREE, OccupancyGrid, Pose2, Scan2D

__all__ = ["scan_of_grid"]

_NEAREST_M = 0.01


@njit(cache=True)
def _cast(cells, u, v, directions, reach):  # type: ignore[no-untyped-def]  # numba kernel
    """Distance in cells from (u, v), column and row, to the first cell that is not free; inf beyond reach."""
    rows, cols = cells.shape
    out = np.full(directions.size, np.inf)
    for i in range(directions.size):
        du, dv = math.cos(directions[i]), math.sin(directions[i])
        row, col, step_row, step_col, per_row, per_col, next_row, next_col = ray_steps(u, v, du, dv)
        entry = 0.0
        while entry <= reach:
            if not (0 <= row < rows and 0 <= col < cols) or cells[row, col] != FREE:
                out[i] = entry
                break
            entry = min(next_row, next_col)
            if next_col <= next_row:
                col += step_col
                next_col += per_col
            else:
                row += step_row
                next_row += per_row
    return out


def scan_of_grid(
    grid: OccupancyGrid, pose: Pose2, range_m: float, *, beams: int = 360, stamp_s: float = 0.0
) -> Scan2D:
    """The scan of an all-round lidar at a pose in the map; unknown cells return like walls.

    Args:
        grid: the map.
        pose: of the lidar, ``map`` frame.
        range_m: the lidar's range.
        beams: equal steps from −π.
        stamp_s: the scan's time.

    Raises:
        ArgumentError: if the range is not above zero.
    """
    require_positive(range_m=range_m)
    angles: NDArray[np.float64] = -np.pi + np.arange(beams) * 2.0 * np.pi / beams
    u, v = (np.asarray(pose.xy) - grid.origin_xy) / grid.resolution_m
    cells = _cast(
        read_only(grid.cells), float(u), float(v), angles + pose.yaw_rad, range_m / grid.resolution_m
    )
    ranges = np.maximum(cells * grid.resolution_m, _NEAREST_M).astype(np.float32)
    return Scan2D(stamp_s, angles, ranges, np.zeros(beams), _NEAREST_M, range_m)
