"""Walls between the returns: a map must not look emptier where beams fan out."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from explore_bt_slam.arrays import Floats

__all__ = ["filled_walls"]

_SPACING_M = 0.05
_GAP_M = 1.0
_GROWTH = 2.0
_THICKNESS_M = 0.02


def filled_walls(points: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Points and normals between the returns of straight walls, one every 5 cm.

    Far along a corridor the beams of a lidar of 1° lie half a metre apart. A map of returns alone then fits a
    scan best where beam meets beam, which is where the robot stood before: it would seem not to move.

    Between two returns the wall is drawn if it is straight from the one before to the one behind them, if its
    gaps grow by no more than 2 from one to the next (a doorway is a leap), and if it is no longer than 1 m.

    Args:
        points: (N, 2) float64, metres, base frame, in beam order.

    Returns:
        (M, 2) float64 points, and (M, 2) float64 unit normals towards the robot.
    """
    filled, normals, count = _filled(points, _SPACING_M, _GAP_M, _GROWTH, _THICKNESS_M)
    return filled[:count], normals[:count]


@njit(cache=True)
def _filled(
    points: Floats, spacing: float, longest: float, growth: float, thickness: float
) -> tuple[Floats, Floats, int]:
    room = points.shape[0] * int(longest / spacing)
    out, normals, used = np.empty((room, 2)), np.empty((room, 2)), 0
    for i in range(1, points.shape[0] - 2):
        before = np.hypot(points[i, 0] - points[i - 1, 0], points[i, 1] - points[i - 1, 1])
        dx, dy = points[i + 1, 0] - points[i, 0], points[i + 1, 1] - points[i, 1]
        gap = np.hypot(dx, dy)
        after = np.hypot(points[i + 2, 0] - points[i + 1, 0], points[i + 2, 1] - points[i + 1, 1])
        is_leap = gap > growth * max(before, after) or max(before, after) > growth * longest
        if gap <= 2.0 * spacing or gap > longest or is_leap:
            continue
        nx, ny, rms = _line(points, i - 1, i + 3)
        if rms > thickness or abs(nx * dx + ny * dy) > 2.0 * thickness:
            continue
        if nx * points[i, 0] + ny * points[i, 1] > 0.0:
            nx, ny = -nx, -ny
        pieces = int(np.ceil(gap / spacing))
        for k in range(1, pieces):
            share = k / pieces
            out[used, 0], out[used, 1] = points[i, 0] + share * dx, points[i, 1] + share * dy
            normals[used, 0], normals[used, 1] = nx, ny
            used += 1
    return out, normals, used


@njit(cache=True)
def _line(points: Floats, begin: int, end: int) -> tuple[float, float, float]:
    """Unit normal of the line through some points, and their root mean square distance from it."""
    n = end - begin
    mx, my = 0.0, 0.0
    for i in range(begin, end):
        mx, my = mx + points[i, 0] / n, my + points[i, 1] / n
    cxx, cxy, cyy = 0.0, 0.0, 0.0
    for i in range(begin, end):
        dx, dy = points[i, 0] - mx, points[i, 1] - my
        cxx, cxy, cyy = cxx + dx * dx / n, cxy + dx * dy / n, cyy + dy * dy / n
    middle, spread = 0.5 * (cxx + cyy), np.hypot(0.5 * (cxx - cyy), cxy)
    angle = 0.5 * np.arctan2(2.0 * cxy, cxx - cyy) + 0.5 * np.pi
    return np.cos(angle), np.sin(angle), np.sqrt(max(middle - spread, 0.0))
