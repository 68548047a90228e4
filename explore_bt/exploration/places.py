"""A thinned set of places that stands for a whole region."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from explore_bt.exploration.kernel_input import read_only

__all__ = ["best_places"]


@njit(cache=True)
def _best_per_block(score, block):  # type: ignore[no-untyped-def]  # numba kernel
    rows, cols = score.shape
    wide = (cols + block - 1) // block
    best = np.full((rows + block - 1) // block * wide, -1, dtype=np.int64)
    for row in range(rows):
        for col in range(cols):
            value = score[row, col]
            if value > 0.0:
                k = row // block * wide + col // block
                if best[k] < 0 or value > score[best[k] // cols, best[k] % cols]:
                    best[k] = row * cols + col
    return best[best >= 0]


def best_places(score: NDArray[np.float32], block_cells: int) -> NDArray[np.int64]:
    """The best cell of every square block that has one with a score above zero.

    A fixed lattice would miss corridors narrower than its spacing; this one has a place in each.

    Args:
        score: (rows, cols) float32, higher is better; the first of equals is taken.
        block_cells: side of a block, at least 1.

    Returns:
        (N, 2) int64 rows and columns, block by block.
    """
    best = _best_per_block(read_only(score), block_cells)
    return np.column_stack(np.divmod(best, score.shape[1]))
