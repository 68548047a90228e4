"""Correlative scan matching: the best pose in a window, by search instead of descent (Olson 2009)."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray

from explore_bt.types import Pose2
from explore_bt_slam.arrays import Floats, Ints, Singles

__all__ = ["Match", "ScoreGrid", "search"]

_CELL_M = 0.05
_BLUR_M = 0.05
_BLOCK = 8
_PEAK_M = 0.35
_PEAK_RAD = 0.15


class ScoreGrid:
    """How well a point would fit at each place: 1 on a seen point, falling off as a Gaussian.

    Attributes:
        scores: (rows, cols) float32 in [0, 1].
        bounds: (rows, cols) float32: the largest score in the 8 × 8 cells that begin here.
        origin_xy: lower left corner, metres, ``map`` frame.
    """

    def __init__(self, points: NDArray[np.float64], margin_m: float) -> None:
        margin = margin_m + _BLOCK * _CELL_M
        self.origin_xy = points.min(axis=0) - margin
        shape = np.ceil((points.max(axis=0) + margin - self.origin_xy) / _CELL_M).astype(np.int64)
        self.scores = np.zeros((int(shape[1]), int(shape[0])), dtype=np.float32)
        _splat(self.scores, points, self.origin_xy, _CELL_M, _BLUR_M)
        self.bounds = _block_maxima(self.scores, _BLOCK)


@dataclass(frozen=True, slots=True)
class Match:
    """The best pose in the window.

    Attributes:
        pose: ``T_map_base``.
        score: mean score of the points, [0, 1].
        runner_up: the best score of a clearly different pose; near ``score`` means ambiguous.
    """

    pose: Pose2
    score: float
    runner_up: float


def search(
    grid: ScoreGrid,
    points: NDArray[np.float64],
    centre: Pose2,
    window_m: float,
    window_rad: float,
    rivals: float = 0.8,
) -> Match:
    """The pose within the window that lays the points best onto the grid.

    Branch and bound over 8 × 8 blocks of offsets for every rotation (Hess et al. 2016, one level).

    Args:
        grid: what is known.
        points: (N, 2) float64, base frame.
        centre: middle of the window.
        window_m: half its side.
        window_rad: half its opening.
        rivals: poses down to this share of the best score are looked into, so that ambiguity shows;
            1 looks for the best only, and is faster.
    """
    far = max(float(np.hypot(points[:, 0], points[:, 1]).max()), 1.0)
    step = _CELL_M / far
    turns = math.ceil(window_rad / step)
    angles = centre.yaw_rad + step * np.arange(-turns, turns + 1)
    x, y, yaw, score, runner_up = _search(
        grid.scores,
        grid.bounds,
        grid.origin_xy,
        _CELL_M,
        points,
        angles,
        np.array(centre.xy),
        math.ceil(window_m / _CELL_M),
        _BLOCK,
        _PEAK_M,
        _PEAK_RAD,
        rivals,
    )
    return Match(Pose2(x, y, yaw), score, runner_up)


@njit(cache=True)
def _splat(scores: Singles, points: Floats, origin: Floats, cell: float, blur: float) -> None:
    reach = int(np.ceil(2.5 * blur / cell))
    for i in range(points.shape[0]):
        x, y = (points[i, 0] - origin[0]) / cell, (points[i, 1] - origin[1]) / cell
        row, col = int(np.floor(y)), int(np.floor(x))
        for r in range(max(row - reach, 0), min(row + reach + 1, scores.shape[0])):
            for c in range(max(col - reach, 0), min(col + reach + 1, scores.shape[1])):
                d2 = ((c + 0.5 - x) ** 2 + (r + 0.5 - y) ** 2) * cell * cell
                value = np.float32(np.exp(-0.5 * d2 / (blur * blur)))
                if value > scores[r, c]:
                    scores[r, c] = value


@njit(cache=True)
def _block_maxima(scores: Singles, block: int) -> Singles:
    """The maximum over rows [r, r + block) and columns [c, c + block), separably."""
    rows, cols = scores.shape
    across = np.zeros_like(scores)
    for r in range(rows):
        for c in range(cols):
            best = np.float32(0.0)
            for k in range(c, min(c + block, cols)):
                best = max(best, scores[r, k])
            across[r, c] = best
    out = np.zeros_like(scores)
    for r in range(rows):
        for k in range(r, min(r + block, rows)):
            for c in range(cols):
                out[r, c] = max(out[r, c], across[k, c])
    return out


@njit(cache=True)
def _total(grid: Singles, rows: Ints, cols: Ints, dr: int, dc: int) -> float:
    total = 0.0
    for i in range(rows.shape[0]):
        r, c = rows[i] + dr, cols[i] + dc
        if 0 <= r < grid.shape[0] and 0 <= c < grid.shape[1]:
            total += grid[r, c]
    return total


@njit(cache=True)
def _search(
    scores: Singles,
    bounds: Singles,
    origin: Floats,
    cell: float,
    points: Floats,
    angles: Floats,
    centre: Floats,
    reach: int,
    block: int,
    peak_m: float,
    peak_rad: float,
    rivals: float,
) -> tuple[float, float, float, float, float]:
    count = points.shape[0]
    side = (2 * reach + block) // block
    rows, cols = np.empty((angles.shape[0], count), np.int64), np.empty((angles.shape[0], count), np.int64)
    bound = np.empty(angles.shape[0] * side * side)
    for a in range(angles.shape[0]):
        cos, sin = np.cos(angles[a]), np.sin(angles[a])
        for i in range(count):
            x = centre[0] + cos * points[i, 0] - sin * points[i, 1]
            y = centre[1] + sin * points[i, 0] + cos * points[i, 1]
            cols[a, i] = int(np.floor((x - origin[0]) / cell)) - reach
            rows[a, i] = int(np.floor((y - origin[1]) / cell)) - reach
        for k in range(side * side):
            bound[a * side * side + k] = _total(
                bounds, rows[a], cols[a], (k // side) * block, (k % side) * block
            )
    found = np.zeros((bound.shape[0], 4))  # score, row offset, column offset, rotation: best of each block
    used, best = 0, -1.0
    for b in np.argsort(-bound, kind="mergesort"):
        if bound[b] < rivals * best:
            break
        a, k = b // (side * side), b % (side * side)
        top, top_r, top_c = -1.0, 0, 0
        for dr in range((k // side) * block, min((k // side) * block + block, 2 * reach + 1)):
            for dc in range((k % side) * block, min((k % side) * block + block, 2 * reach + 1)):
                total = _total(scores, rows[a], cols[a], dr, dc)
                if total > top:
                    top, top_r, top_c = total, dr, dc
        found[used, 0], found[used, 1], found[used, 2], found[used, 3] = top, top_r, top_c, a
        used += 1
        best = max(best, top)
    return _peaks(found[:used], cell, reach, angles, centre, count, peak_m, peak_rad)


@njit(cache=True)
def _peaks(
    found: Floats,
    cell: float,
    reach: int,
    angles: Floats,
    centre: Floats,
    count: int,
    peak_m: float,
    peak_rad: float,
) -> tuple[float, float, float, float, float]:
    """The best entry, and the score of the best one that is not the same peak."""
    top = found[np.argmax(found[:, 0])]
    rival = 0.0
    for i in range(found.shape[0]):
        away = np.hypot(found[i, 1] - top[1], found[i, 2] - top[2]) * cell
        turned = abs(angles[int(found[i, 3])] - angles[int(top[3])])
        if (away > peak_m or turned > peak_rad) and found[i, 0] > rival:
            rival = found[i, 0]
    n = max(count, 1)
    x, y = centre[0] + (top[2] - reach) * cell, centre[1] + (top[1] - reach) * cell
    return x, y, angles[int(top[3])], top[0] / n, rival / n
