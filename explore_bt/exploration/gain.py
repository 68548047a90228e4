"""Expected gain: how much unknown area a lidar would see from a place."""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from explore_bt.exploration.arguments import require_positive
from explore_bt.exploration.kernel_input import read_only
from explore_bt.exploration.ray_steps import ray_steps
from explore_bt.types import OCCUPIED, UNKNOWN, OccupancyGrid

__all__ = ["gain_many", "visible_unknown_area"]

_TURN = 2.0 * math.pi
_FREE_SIGHT = math.inf


@njit(cache=True)
def _see_along(cells, seen, mark, u, v, du, dv, corner, reach, depth):  # type: ignore[no-untyped-def]  # numba kernel
    """Unknown cells newly marked along one ray.

    Lengths count in cells; (u, v) and (du, dv) are the eye and the ray's unit vector in columns and rows;
    ``corner`` is the grid's cell at seen[0, 0].
    """
    rows, cols = cells.shape
    row, col, step_row, step_col, per_row, per_col, next_row, next_col = ray_steps(u, v, du, dv)
    entry, passed, found = 0.0, 0.0, 0
    while entry <= reach:
        leave = min(next_row, next_col)
        inside = 0 <= row < rows and 0 <= col < cols
        value = cells[row, col] if inside else UNKNOWN
        if value == OCCUPIED:
            break
        if value == UNKNOWN:
            if passed >= depth:
                break
            passed += leave - entry
            local_row, local_col = row - corner[0], col - corner[1]
            if seen[local_row, local_col] != mark:
                off_u, off_v = col + 0.5 - u, row + 0.5 - v
                if off_u * off_u + off_v * off_v <= reach * reach:
                    seen[local_row, local_col] = mark
                    found += 1
        entry = leave
        if next_col <= next_row:
            col += step_col
            next_col += per_col
        else:
            row += step_row
            next_row += per_row
    return found


@njit(cache=True)
def _see(cells, seen, mark, u, v, reach, depth, middle, half_view):  # type: ignore[no-untyped-def]  # numba kernel
    """Unknown cells visible from (u, v), with one ray to each cell of a square ring just out of reach."""
    ring = math.ceil(reach) + 1
    row0, col0 = math.floor(v), math.floor(u)
    corner = (row0 - ring - 1, col0 - ring - 1)
    found = 0
    for k in range(8 * ring):
        side, along = k // (2 * ring), k % (2 * ring) - ring
        if side == 0:
            to_row, to_col = -ring, along
        elif side == 1:
            to_row, to_col = along, ring
        elif side == 2:
            to_row, to_col = ring, -along
        else:
            to_row, to_col = -along, -ring
        du, dv = col0 + to_col + 0.5 - u, row0 + to_row + 0.5 - v
        if half_view < math.pi:
            off = (math.atan2(dv, du) - middle + math.pi) % _TURN - math.pi
            if abs(off) > half_view:
                continue
        length = math.hypot(du, dv)
        found += _see_along(cells, seen, mark, u, v, du / length, dv / length, corner, reach, depth)
    return found


@njit(cache=True)
def _see_from_each(cells, eyes, reach, depth, middles, half_views):  # type: ignore[no-untyped-def]  # numba kernel
    """Visible unknown cells of each of (N, 2) eyes, given as columns and rows in cells."""
    size = 2 * math.ceil(reach) + 5
    seen = np.full((size, size), -1, dtype=np.int32)
    found = np.zeros(eyes.shape[0], dtype=np.int64)
    for i in range(eyes.shape[0]):
        found[i] = _see(cells, seen, i, eyes[i, 0], eyes[i, 1], reach, depth, middles[i], half_views[i])
    return found


def gain_many(
    grid: OccupancyGrid,
    points: NDArray[np.floating],
    range_m: float,
    *,
    fov_rad: float | NDArray[np.floating] = _TURN,
    heading_rad: float | NDArray[np.floating] = 0.0,
    depth_m: float = _FREE_SIGHT,
) -> NDArray[np.float64]:
    """Unknown area in m² that a lidar would see from each of several places.

    A cell counts, once, if it is unknown, its centre lies within range, and a ray in the field of view
    meets it before any occupied cell. Rays go to every cell of a square ring around the range, so no cell
    is missed between two of them. The world outside the grid is unknown.

    Args:
        grid: the map.
        points: (N, 2) metres, ``map`` frame.
        range_m: the lidar's range.
        fov_rad: field of view, one or (N,); a full turn by default.
        heading_rad: middle of the field of view in ``map``, one or (N,).
        depth_m: a ray ends after so many metres of unknown. Without bound the unknown is taken for
            empty, and a hole of one cell in a wall promises the whole room behind; a bound of about a
            metre counts an opening by its width.

    Returns:
        (N,) float64, m².

    Raises:
        ArgumentError: if the range is not above zero.
    """
    require_positive(range_m=range_m)
    eyes = (np.asarray(points, dtype=np.float64).reshape(-1, 2) - grid.origin_xy) / grid.resolution_m
    middles = np.broadcast_to(np.asarray(heading_rad, dtype=np.float64), eyes.shape[:1])
    half_views = np.broadcast_to(np.asarray(fov_rad, dtype=np.float64) / 2.0, eyes.shape[:1])
    found = _see_from_each(
        read_only(grid.cells),
        read_only(eyes),
        range_m / grid.resolution_m,
        depth_m / grid.resolution_m,
        read_only(middles),
        read_only(half_views),
    )
    return np.asarray(found * grid.resolution_m**2, dtype=np.float64)


def visible_unknown_area(
    grid: OccupancyGrid,
    xy: tuple[float, float],
    range_m: float,
    fov_rad: float = _TURN,
    heading_rad: float = 0.0,
    *,
    depth_m: float = _FREE_SIGHT,
) -> float:
    """Unknown area in m² that a lidar would see from one place; see :func:`gain_many`."""
    area = gain_many(grid, np.array([xy]), range_m, fov_rad=fov_rad, heading_rad=heading_rad, depth_m=depth_m)
    return float(area[0])
