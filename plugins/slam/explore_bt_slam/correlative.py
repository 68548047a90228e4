"""Correlative scan matching: the best pose in a window, by search instead of descent (Olson 2009)."""

from __future__ import annotations

import heapq
import math
from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray

from explore_bt.types import Pose2
from explore_bt_slam.arrays import Floats, Ints32, Singles

__all__ = ["Match", "ScoreGrid", "search"]

_CELL_M = 0.05
_LEVELS = 5
_FAR_M = 8.0
_PEAK_M = 0.35
_PEAK_RAD = 0.15


class ScoreGrid:
    """How well a point would fit at each place: 1 on a seen point, falling off as a Gaussian.

    Attributes:
        pyramid: (levels, rows, cols) float32 in [0, 1]: level 0 is the score itself, level k the largest
            score in the 2^k × 2^k cells that begin here.
        origin_xy: lower left corner, metres, ``map`` frame.
        cell_m: side of a cell.

    Args:
        points: (N, 2) float64, metres; where there are none, nothing scores.
        margin_m: the grid reaches this far beyond them.
        cell_m: side of a cell, and the blur of a point.
    """

    def __init__(self, points: NDArray[np.float64], margin_m: float, cell_m: float = _CELL_M) -> None:
        margin = margin_m + 2**_LEVELS * cell_m
        self.cell_m = cell_m
        bounds = points if points.shape[0] else np.zeros((1, 2))
        self.origin_xy = bounds.min(axis=0) - margin
        shape = np.ceil((bounds.max(axis=0) + margin - self.origin_xy) / cell_m).astype(np.int64)
        self.pyramid = np.zeros((_LEVELS + 1, int(shape[1]), int(shape[0])), dtype=np.float32)
        _splat(self.pyramid[0], np.ascontiguousarray(points), self.origin_xy, cell_m, cell_m)
        for level in range(_LEVELS):
            _merge(self.pyramid[level], self.pyramid[level + 1], 2**level)

    @property
    def scores(self) -> NDArray[np.float32]:
        """(rows, cols) float32: level 0."""
        return np.asarray(self.pyramid[0])


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
    least: float = 0.0,
) -> Match:
    """The pose within the window that lays the points best onto the grid.

    Best-first branch and bound over a pyramid of maxima for every rotation (Hess et al. 2016).

    Args:
        grid: what is known.
        points: (N, 2) float64, base frame; without any the score is 0.
        centre: middle of the window.
        window_m: half its side.
        window_rad: half its opening.
        rivals: poses down to this share of the best score are looked into, so that ambiguity shows;
            1 looks for the best only, and is faster.
        least: no pose below this score is of interest; the score is 0 if there is none.
    """
    if points.shape[0] == 0:
        return Match(centre, 0.0, 0.0)
    far = min(max(float(np.hypot(points[:, 0], points[:, 1]).max()), 1.0), _FAR_M)
    step = grid.cell_m / far
    turns = math.ceil(window_rad / step)
    angles = centre.yaw_rad + step * np.arange(-turns, turns + 1)
    x, y, yaw, score, runner_up = _search(
        grid.pyramid,
        grid.origin_xy,
        grid.cell_m,
        np.ascontiguousarray(points),
        angles,
        np.array(centre.xy),
        math.ceil(window_m / grid.cell_m),
        _PEAK_M,
        _PEAK_RAD,
        rivals,
        least,
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
def _merge(fine: Singles, coarse: Singles, reach: int) -> None:
    """The next level: the maximum of four cells of the finer one, ``reach`` apart."""
    rows, cols = fine.shape
    for r in range(rows):
        below = min(r + reach, rows - 1)
        for c in range(cols):
            right = min(c + reach, cols - 1)
            coarse[r, c] = max(max(fine[r, c], fine[r, right]), max(fine[below, c], fine[below, right]))


@njit(cache=True)
def _total(grid: Singles, rows: Ints32, cols: Ints32, dr: int, dc: int) -> float:
    total = 0.0
    for i in range(rows.shape[0]):
        r, c = rows[i] + dr, cols[i] + dc
        if 0 <= r < grid.shape[0] and 0 <= c < grid.shape[1]:
            total += grid[r, c]
    return total


@njit(cache=True)
def _search(
    pyramid: Singles,
    origin: Floats,
    cell: float,
    points: Floats,
    angles: Floats,
    centre: Floats,
    reach: int,
    peak_m: float,
    peak_rad: float,
    rivals: float,
    least: float,
) -> tuple[float, float, float, float, float]:
    count, side = points.shape[0], 2 * reach + 1
    top_level = 0
    while top_level < pyramid.shape[0] - 1 and 2 ** (top_level + 1) <= reach:
        top_level += 1
    rows, cols = np.empty((angles.shape[0], count), np.int32), np.empty((angles.shape[0], count), np.int32)
    heap = [(0.0, 0, 0, 0, 0)]
    heap.pop()
    floor = least * count
    for a in range(angles.shape[0]):
        cos, sin = np.cos(angles[a]), np.sin(angles[a])
        for i in range(count):
            x = centre[0] + cos * points[i, 0] - sin * points[i, 1]
            y = centre[1] + sin * points[i, 0] + cos * points[i, 1]
            cols[a, i] = int(np.floor((x - origin[0]) / cell)) - reach
            rows[a, i] = int(np.floor((y - origin[1]) / cell)) - reach
        for dr in range(0, side, 2**top_level):
            for dc in range(0, side, 2**top_level):
                bound = _total(pyramid[top_level], rows[a], cols[a], dr, dc)
                if bound > floor:
                    heap.append((-bound, top_level, a, dr, dc))
    heapq.heapify(heap)
    found = np.zeros((64, 4))  # score, row offset, column offset, rotation
    used, best = 0, 0.0
    while len(heap) > 0:
        negative, level, a, dr, dc = heapq.heappop(heap)
        if -negative < max(rivals * best, floor):
            break
        if level == 0:
            if used == found.shape[0]:
                found = np.concatenate((found, np.zeros_like(found)))
            found[used, 0], found[used, 1], found[used, 2], found[used, 3] = -negative, dr, dc, a
            used, best = used + 1, max(best, -negative)
            continue
        half = 2 ** (level - 1)
        for k in range(4):
            r, c = dr + half * (k // 2), dc + half * (k % 2)
            if r < side and c < side:
                bound = _total(pyramid[level - 1], rows[a], cols[a], r, c)
                if bound > max(rivals * best, floor):
                    heapq.heappush(heap, (-bound, level - 1, a, r, c))
    if used == 0:
        return centre[0], centre[1], angles[angles.shape[0] // 2], 0.0, 0.0
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
        turned = min(turned, 2.0 * np.pi - turned)
        if (away > peak_m or turned > peak_rad) and found[i, 0] > rival:
            rival = found[i, 0]
    n = max(count, 1)
    x, y = centre[0] + (top[2] - reach) * cell, centre[1] + (top[1] - reach) * cell
    return x, y, angles[int(top[3])], top[0] / n, rival / n
