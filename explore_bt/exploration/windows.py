"""Where two states of a map differ."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from explore_bt.types import GridWindow

__all__ = ["changed_window"]


def changed_window(is_changed: NDArray[np.bool_]) -> GridWindow:
    """The smallest window that holds all cells of a (rows, cols) mask; an empty one if there is none."""
    rows, cols = np.flatnonzero(is_changed.any(axis=1)), np.flatnonzero(is_changed.any(axis=0))
    if not rows.size:
        return GridWindow(0, 0, 0, 0)
    return GridWindow(int(rows[0]), int(cols[0]), int(rows[-1]) + 1, int(cols[-1]) + 1)
