"""How wide a robot could be and still come to a place it cannot reach."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from explore_bt.exploration.kernel_input import read_only

__all__ = ["passage_field"]

_STEP_M = 1e-3


@njit(cache=True)
def _flood(clearance, reachable, radius, step):  # type: ignore[no-untyped-def]  # numba kernel
    """Widest passage of every cell, from the reachable ones, the wide ways first."""
    rows, cols = clearance.shape
    passage = np.zeros((rows, cols), dtype=np.float32)
    top = int(radius / step) + 1
    head = np.full(top + 1, -1, dtype=np.int64)  # one chain of cells per level of passage
    after = np.empty(rows * cols, dtype=np.int64)
    for row in range(rows):
        for col in range(cols):
            if reachable[row, col]:
                passage[row, col] = radius
                after[row * cols + col] = head[top]
                head[top] = row * cols + col
    for level in range(top, -1, -1):
        while head[level] >= 0:
            here = head[level]
            head[level] = after[here]
            row, col = here // cols, here % cols
            for k in range(4):
                r, c = row + (k == 0) - (k == 1), col + (k == 2) - (k == 3)
                if r < 0 or r >= rows or c < 0 or c >= cols:
                    continue
                if passage[r, c] > 0.0 or clearance[r, c] <= 0.0:
                    continue
                passage[r, c] = min(passage[row, col], clearance[r, c])
                there = min(level, int(passage[r, c] / step))
                after[r * cols + c] = head[there]
                head[there] = r * cols + c
    return passage


def passage_field(
    clearance_m: NDArray[np.float32], travel_m: NDArray[np.float32], radius_m: float
) -> NDArray[np.float32]:
    """Least clearance on the widest way from where the robot can go, to the millimetre.

    Args:
        clearance_m: (rows, cols) float32, metres.
        travel_m: (rows, cols) float32, inf where the robot cannot go.
        radius_m: r, the footprint.

    Returns:
        (rows, cols) float32, metres: r where the robot can go; below r behind a passage that is too
        narrow for it; 0 where known free floor leads nowhere near.
    """
    return _flood(read_only(clearance_m), np.isfinite(travel_m), radius_m, _STEP_M)
