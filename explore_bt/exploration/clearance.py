"""Distance to the nearest obstacle, exact to the cell."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from explore_bt.types import FREE, OccupancyGrid

__all__ = ["clearance_field"]


def clearance_field(grid: OccupancyGrid) -> NDArray[np.float32]:
    """Clearance of every cell's centre; what is not known to be free is an obstacle.

    Half a cell is taken off the distance between centres, so that an obstacle may fill its cell. The
    world outside the grid is unknown, hence an obstacle too.

    Returns:
        (rows, cols) float32, metres, >= 0; 0 on obstacles and unknown cells.
    """
    free = np.zeros((grid.shape[0] + 2, grid.shape[1] + 2), dtype=np.uint8)
    free[1:-1, 1:-1] = grid.cells == FREE
    # DIST_MASK_PRECISE is the exact Euclidean transform; the 5 × 5 mask errs by up to 0.74 cell
    distance = cv2.distanceTransform(free, cv2.DIST_L2, cv2.DIST_MASK_PRECISE)[1:-1, 1:-1]
    return np.asarray(np.maximum(distance - 0.5, 0.0) * grid.resolution_m, dtype=np.float32)
