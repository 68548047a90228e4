"""The solid cells of a map as few boxes, and which of them matter."""

from __future__ import annotations

import cv2
import numpy as np
from numba import njit
from numpy.typing import NDArray

__all__ = ["boxes_of", "open_space"]

_LEAST_AREA_M2 = 1.0


def open_space(free: NDArray[np.bool_], resolution_m: float) -> NDArray[np.bool_]:
    """(rows, cols) bool: free cells but for specks under 1 m², which maps of real lidars are full of.

    No robot fits into those and no beam gets out of them.
    """
    _, labels, figures, _ = cv2.connectedComponentsWithStats(free.astype(np.uint8), connectivity=4)
    is_kept = figures[:, cv2.CC_STAT_AREA] * resolution_m**2 >= _LEAST_AREA_M2
    is_kept[0] = False
    kept = is_kept[labels]
    return np.asarray(kept if kept.any() else free)


def boxes_of(solid: NDArray[np.bool_]) -> NDArray[np.int64]:
    """(N, 4) row, col, end row, end col (exclusive) of boxes that cover the solid cells exactly.

    Run along a row, then down as far as the whole run goes: about a box for every third corner.
    """
    return np.asarray(_boxes(solid))


@njit(cache=True)
def _boxes(solid):  # type: ignore[no-untyped-def]  # kernel
    rows, cols = solid.shape
    left = solid.copy()
    found = np.empty((solid.sum(), 4), dtype=np.int64)
    count = 0
    for row in range(rows):
        col = 0
        while col < cols:
            if not left[row, col]:
                col += 1
                continue
            end = col
            while end < cols and left[row, end]:
                end += 1
            last = row + 1
            while last < rows and left[last, col:end].all():
                last += 1
            left[row:last, col:end] = False
            found[count, 0], found[count, 1], found[count, 2], found[count, 3] = row, col, last, end
            count += 1
            col = end
    return found[:count]
