"""The way back along the way driven: where the robot came in, it can get out."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from explore_bt.exploration.arguments import require_positive

__all__ = ["way_back"]

SPACING_M = 0.05


def way_back(driven: NDArray[np.float64], length_m: float) -> NDArray[np.float64]:
    """The driven way, newest place first, without the detours that came back to where they began.

    Args:
        driven: (N, 2) float64, metres, in the order driven; N >= 1.
        length_m: no more than that is needed.

    Returns:
        (M, 2) float64, M >= 1, places of ``driven`` at least 5 cm apart, the last driven first.

    Raises:
        ArgumentError: ``length_m`` is not above 0.
    """
    require_positive(length_m=length_m)
    way = [driven[-1]]
    for place in driven[-2::-1]:
        if math.dist(place, way[-1]) < SPACING_M:
            continue
        near = np.hypot(*(np.array(way[:-1]).reshape(-1, 2) - place).T) < SPACING_M
        if near.any():
            del way[int(np.argmax(near)) + 1 :]
            continue
        way.append(place)
        if (len(way) - 1) * SPACING_M >= length_m:
            break
    return np.array(way)
