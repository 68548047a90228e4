"""Quaternions, w x y z, as matrices."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["matrices"]


def matrices(quaternions: NDArray[np.float64]) -> NDArray[np.float64]:
    """(N, 3, 3) of (N, 4) unit quaternions, w x y z."""
    w, x, y, z = quaternions.T
    rows = np.array(
        [
            [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)],
            [2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)],
            [2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)],
        ]
    )
    return np.moveaxis(rows, 2, 0)
