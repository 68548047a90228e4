"""Prisms on a floor, and exact rays through them: what a simulated 3D lidar looks at."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray

__all__ = ["Prism", "Scene3"]


@dataclass(frozen=True, slots=True, eq=False)
class Prism:
    """A polygon between two heights.

    Attributes:
        corners: (N, 2) float64, metres, in order round it.
        low_m, high_m: above the floor; a table top has ``low_m`` > 0.
    """

    corners: NDArray[np.float64]
    low_m: float
    high_m: float


class Scene3:
    """Prisms on the plane z = 0; there is no ceiling."""

    def __init__(self, prisms: Sequence[Prism]) -> None:
        self.prisms = tuple(prisms)
        self._edges = np.concatenate(
            [np.hstack((prism.corners, np.roll(prism.corners, -1, axis=0))) for prism in prisms]
        )
        self._starts = np.cumsum([0, *(len(prism.corners) for prism in prisms)])
        self._heights = np.array([(prism.low_m, prism.high_m) for prism in prisms], dtype=np.float64)
        self._boxes = np.array([(*p.corners.min(axis=0), *p.corners.max(axis=0)) for p in prisms])

    def cast(
        self, origins: NDArray[np.float64], directions: NDArray[np.float64], limit_m: float
    ) -> NDArray[np.float64]:
        """(N,) float64 exact ranges, metres; +inf where nothing is within the limit.

        Args:
            origins: (N, 3) float64, metres, above the floor and in no prism, near one another.
            directions: (N, 3) float64 unit vectors.
            limit_m: farther returns do not count.
        """
        low, high = origins[:, :2].min(axis=0) - limit_m, origins[:, :2].max(axis=0) + limit_m
        near = (
            (self._boxes[:, 0] <= high[0])
            & (self._boxes[:, 1] <= high[1])
            & (self._boxes[:, 2] >= low[0])
            & (self._boxes[:, 3] >= low[1])
        )
        numbers = np.flatnonzero(near)
        return np.asarray(
            _cast(
                origins, directions, limit_m, numbers, self._edges, self._starts, self._heights, self._boxes
            )
        )


@njit(cache=True)
def _cast(origins, directions, limit, prisms, edges, starts, heights, boxes):  # type: ignore[no-untyped-def]  # kernel
    """Nearest of the floor, the sides, the tops and the undersides."""
    ranges = np.empty(origins.shape[0])
    for i in range(origins.shape[0]):
        ox, oy, oz = origins[i]
        dx, dy, dz = directions[i]
        best = -oz / dz if dz < 0.0 else math.inf
        if best > limit:
            best = math.inf
        for prism in prisms:
            if _misses_box(ox, oy, dx, dy, min(best, limit), boxes, prism):
                continue
            low, high = heights[prism]
            for m in range(starts[prism], starts[prism + 1]):
                t = _side(ox, oy, dx, dy, edges, m)
                if t < best and t <= limit and low <= oz + t * dz <= high:
                    best = t
            lid = high if dz < 0.0 else low
            t = (lid - oz) / dz if dz != 0.0 else math.inf
            edge = (starts[prism], starts[prism + 1])
            if 0.0 < t < best and t <= limit and _inside(ox + t * dx, oy + t * dy, edges, *edge):
                best = t
        ranges[i] = best
    return ranges


@njit(cache=True)
def _misses_box(ox, oy, dx, dy, limit, boxes, prism):  # type: ignore[no-untyped-def]  # kernel
    """Whether the ray passes by the prism's bounding rectangle, or ends before it."""
    enter, leave = 0.0, limit
    for o, d, low, high in (
        (ox, dx, boxes[prism, 0], boxes[prism, 2]),
        (oy, dy, boxes[prism, 1], boxes[prism, 3]),
    ):
        if abs(d) < 1e-12:
            if o < low or o > high:
                return True
            continue
        a, b = (low - o) / d, (high - o) / d
        enter, leave = max(enter, min(a, b)), min(leave, max(a, b))
    return enter > leave + 1e-9


@njit(cache=True)
def _side(ox, oy, dx, dy, edges, m):  # type: ignore[no-untyped-def]  # kernel
    """Where the ray's shadow on the floor meets an edge; inf if it does not."""
    px, py = edges[m, 0] - ox, edges[m, 1] - oy
    ex, ey = edges[m, 2] - edges[m, 0], edges[m, 3] - edges[m, 1]
    cross = dx * ey - dy * ex
    if abs(cross) < 1e-12:
        return math.inf
    t, u = (px * ey - py * ex) / cross, (px * dy - py * dx) / cross
    return t if t > 0.0 and -1e-9 <= u <= 1.0 + 1e-9 else math.inf


@njit(cache=True)
def _inside(x, y, edges, first, last):  # type: ignore[no-untyped-def]  # kernel
    """Even-odd rule."""
    odd = False
    for m in range(first, last):
        ax, ay, bx, by = edges[m]
        if (ay > y) != (by > y) and x < ax + (y - ay) / (by - ay) * (bx - ax):
            odd = not odd
    return odd
