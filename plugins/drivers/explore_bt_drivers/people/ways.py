"""People as discs on known ways: where they are, and which beams meet them."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

__all__ = ["Ways", "disc_ahead", "disc_at", "joined"]


class Ways(NamedTuple):
    """Broken lines in space and time, one a person; between knots they go at constant speed.

    Attributes:
        knots: (N, 3) float64: seconds (ascending for each person), x, y in metres, ``map`` frame.
        starts: (K + 1,) int64; person k has ``knots[starts[k]:starts[k + 1]]``, two or more of them.
        radii: (K,) float64, metres.
    """

    knots: NDArray[np.float64]
    starts: NDArray[np.int64]
    radii: NDArray[np.float64]


def joined(one: Ways, other: Ways) -> Ways:
    """Everybody of both, the first ones first."""
    return Ways(
        np.concatenate((one.knots, other.knots)),
        np.concatenate((one.starts, one.starts[-1] + other.starts[1:])),
        np.concatenate((one.radii, other.radii)),
    )


@njit(cache=True)
def disc_at(ways, person, time):  # type: ignore[no-untyped-def]  # kernel
    """x, y, vx, vy of a person; before the first knot they stand there."""
    low, high = ways.starts[person], ways.starts[person + 1] - 1
    if time < ways.knots[low, 0]:
        return ways.knots[low, 1], ways.knots[low, 2], 0.0, 0.0
    while high - low > 1:
        middle = (low + high) // 2
        if ways.knots[middle, 0] <= time:
            low = middle
        else:
            high = middle
    begin, x, y = ways.knots[low]
    end, x_end, y_end = ways.knots[high]
    vx, vy = (x_end - x) / (end - begin), (y_end - y) / (end - begin)
    return x + vx * (time - begin), y + vy * (time - begin), vx, vy


@njit(cache=True)
def disc_ahead(ways, time, x, y, dx, dy, limit):  # type: ignore[no-untyped-def]  # kernel
    """Distance along the unit direction (dx, dy) to the first person at a time; inf beyond ``limit``.

    A beam that begins inside a person passes through that person.
    """
    best = math.inf
    for person in range(ways.radii.shape[0]):
        px, py, _, _ = disc_at(ways, person, time)
        ex, ey, radius = px - x, py - y, ways.radii[person]
        outside = ex * ex + ey * ey - radius * radius
        ahead = dx * ex + dy * ey
        if outside <= 0.0 or ahead <= 0.0 or ahead * ahead < outside:
            continue
        # the nearer root of t² - 2 ahead t + outside = 0, in the form that does not cancel
        t = outside / (ahead + math.sqrt(ahead * ahead - outside))
        if t < best and t <= limit:
            best = t
    return best
