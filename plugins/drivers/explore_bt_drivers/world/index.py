"""Segments in a uniform grid of buckets: exact ray casting and distances in compiled loops.

Solid matter lies to the **left** of every segment, so the winding number of all segments about a point
tells free space (-1) from solid (>= 0), however solids overlap.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from explore_bt_drivers.world.solid import Material

__all__ = [
    "GLASS",
    "MIRROR",
    "SegmentIndex",
    "build_index",
    "cast_ray",
    "cast_rays",
    "clearance_of",
    "first_hit",
    "fits",
    "nearest",
    "reflected",
    "way_fits",
    "winding",
]

GLASS, MIRROR = int(Material.GLASS), int(Material.MIRROR)
"""For kernels, which know no enumerations."""

MOST_MIRRORS = 8
"""A beam that was reflected so often is lost."""

_EDGE = 1e-9
_STRIDE_M = 0.05
_FAR_M = 1.0


class SegmentIndex(NamedTuple):
    """Segments and, for each square bucket, those that touch it.

    Attributes:
        segments: (M, 4) float64, metres, world frame: x, y of begin and end.
        starts: (rows * cols + 1,) int32; bucket b holds ``items[starts[b]:starts[b + 1]]``.
        items: (K,) int32 indices of segments.
        x0, y0: lower left corner of bucket (0, 0), metres.
        size_m: side of a bucket.
        materials: (M,) int8, of each segment: ``Material``.
    """

    segments: NDArray[np.float64]
    starts: NDArray[np.int32]
    items: NDArray[np.int32]
    x0: float
    y0: float
    size_m: float
    rows: int
    cols: int
    materials: NDArray[np.int8]


def build_index(
    segments: NDArray[np.float64], materials: NDArray[np.int8] | None = None, size_m: float = 0.25
) -> SegmentIndex:
    """Sort (M, 4) segments into buckets, M >= 1; the buckets cover all of them with a margin.

    Args:
        segments: metres.
        materials: (M,) int8, of each; all matt by default.
        size_m: side of a bucket.
    """
    if materials is None:
        materials = np.zeros(len(segments), dtype=np.int8)
    ends = segments.reshape(-1, 2)
    low, high = ends.min(axis=0) - size_m, ends.max(axis=0) + size_m
    cols, rows = (int(n) for n in np.ceil((high - low) / size_m))
    counts = np.zeros(rows * cols + 1, dtype=np.int32)
    x0, y0 = float(low[0]), float(low[1])
    _sort(segments, x0, y0, size_m, rows, cols, counts, np.empty(0, dtype=np.int32))
    starts = np.concatenate(([0], np.cumsum(counts[:-1]))).astype(np.int32)
    items = np.empty(int(starts[-1]), dtype=np.int32)
    counts[:] = 0
    _sort(segments, x0, y0, size_m, rows, cols, counts, items, starts)
    return SegmentIndex(segments, starts, items, x0, y0, size_m, rows, cols, materials)


@njit(cache=True)
def _sort(segments, x0, y0, size, rows, cols, counts, items, starts=None):  # type: ignore[no-untyped-def]  # kernel
    """Count the segments of each bucket, and write them down where ``starts`` says where to."""
    for m in range(segments.shape[0]):
        ax, ay, bx, by = segments[m]
        ux, uy = bx - ax, by - ay
        reach = 0.5 * size * (abs(ux) + abs(uy)) + _EDGE
        first_col = max(int((min(ax, bx) - _EDGE - x0) / size), 0)
        last_col = min(int((max(ax, bx) + _EDGE - x0) / size), cols - 1)
        first_row = max(int((min(ay, by) - _EDGE - y0) / size), 0)
        last_row = min(int((max(ay, by) + _EDGE - y0) / size), rows - 1)
        for row in range(first_row, last_row + 1):
            for col in range(first_col, last_col + 1):
                across = (x0 + (col + 0.5) * size - ax) * uy - (y0 + (row + 0.5) * size - ay) * ux
                if abs(across) > reach:
                    continue
                bucket = row * cols + col
                if starts is not None:
                    items[starts[bucket] + counts[bucket]] = m
                counts[bucket] += 1


@njit(cache=True)
def cast_ray(index, x, y, dx, dy, limit):  # type: ignore[no-untyped-def]  # kernel
    """Length of a lidar's beam along the unit direction (dx, dy): through glass, on from mirrors.

    inf beyond ``limit``, or lost between mirrors. (x, y) lies within the buckets, as every place inside a
    world's bounds does.
    """
    driven, last = 0.0, -1
    for _ in range(MOST_MIRRORS):
        t, last = first_hit(index, x, y, dx, dy, limit - driven, last)
        if last < 0:
            return math.inf
        driven += t
        if index.materials[last] != MIRROR:
            return driven
        x, y = x + t * dx, y + t * dy
        dx, dy = reflected(index.segments, last, dx, dy)
    return math.inf


@njit(cache=True)
def reflected(segments, m, dx, dy):  # type: ignore[no-untyped-def]  # kernel
    """The direction in which a beam along (dx, dy) leaves the mirror that segment ``m`` is."""
    ux, uy = segments[m, 2] - segments[m, 0], segments[m, 3] - segments[m, 1]
    along = 2.0 * (dx * ux + dy * uy) / (ux * ux + uy * uy)
    return along * ux - dx, along * uy - dy


@njit(cache=True)
def first_hit(index, x, y, dx, dy, limit, but=-1):  # type: ignore[no-untyped-def]  # kernel
    """Distance along (dx, dy) to the first segment that is not glass, and its number; (inf, -1) beyond.

    ``but`` is left out: the mirror that the beam comes from.
    """
    size = index.size_m
    col = math.floor((x - index.x0) / size)
    row = math.floor((y - index.y0) / size)
    step_col = 1 if dx > 0.0 else -1
    step_row = 1 if dy > 0.0 else -1
    next_x = math.inf
    next_y = math.inf
    if dx != 0.0:
        next_x = (index.x0 + (col + (dx > 0.0)) * size - x) / dx
    if dy != 0.0:
        next_y = (index.y0 + (row + (dy > 0.0)) * size - y) / dy
    per_col = size / abs(dx) if dx != 0.0 else math.inf
    per_row = size / abs(dy) if dy != 0.0 else math.inf
    best, who = math.inf, -1
    while 0 <= row < index.rows and 0 <= col < index.cols:
        bucket = row * index.cols + col
        for k in range(index.starts[bucket], index.starts[bucket + 1]):
            m = index.items[k]
            px = index.segments[m, 0] - x
            py = index.segments[m, 1] - y
            ex = index.segments[m, 2] - index.segments[m, 0]
            ey = index.segments[m, 3] - index.segments[m, 1]
            cross = dx * ey - dy * ex
            if abs(cross) < 1e-12:
                continue  # parallel: its neighbours' ends are hit instead
            t = (px * ey - py * ex) / cross
            if t < 0.0 or t >= best:
                continue
            u = (px * dy - py * dx) / cross
            if -_EDGE <= u <= 1.0 + _EDGE and index.materials[m] != GLASS and m != but:
                best, who = t, m
        leave = min(next_x, next_y)
        if best <= leave or leave > limit:
            break
        if next_x < next_y:
            col += step_col
            next_x += per_col
        else:
            row += step_row
            next_y += per_row
    return (best, who) if best <= limit else (math.inf, -1)


@njit(cache=True)
def cast_rays(index, x, y, angles, limit):  # type: ignore[no-untyped-def]  # kernel
    """(N,) float64 lengths of beams from one point along (N,) float64 world angles, radians."""
    ranges = np.empty(angles.shape[0])
    for i in range(angles.shape[0]):
        ranges[i] = cast_ray(index, x, y, math.cos(angles[i]), math.sin(angles[i]), limit)
    return ranges


@njit(cache=True)
def nearest(index, x, y, limit):  # type: ignore[no-untyped-def]  # kernel
    """Distance to the nearest segment and its number; (``limit``, -1) if none is nearer than that."""
    size = index.size_m
    col = math.floor((x - index.x0) / size)
    row = math.floor((y - index.y0) / size)
    best, who = limit, -1
    last = index.rows + index.cols + abs(row) + abs(col)
    for ring in range(last):
        if (ring - 1) * size > best:
            break
        for r in range(max(row - ring, 0), min(row + ring, index.rows - 1) + 1):
            stride = 1 if r == row - ring or r == row + ring else max(2 * ring, 1)
            for c in range(col - ring, col + ring + 1, stride):
                if c < 0 or c >= index.cols:
                    continue
                bucket = r * index.cols + c
                for k in range(index.starts[bucket], index.starts[bucket + 1]):
                    m = index.items[k]
                    distance = _distance(index.segments, m, x, y)
                    if distance < best:
                        best, who = distance, m
    return best, who


@njit(cache=True)
def _distance(segments, m, x, y):  # type: ignore[no-untyped-def]  # kernel
    """Distance from a point to segment ``m``."""
    ax, ay = segments[m, 0], segments[m, 1]
    ux, uy = segments[m, 2] - ax, segments[m, 3] - ay
    t = ((x - ax) * ux + (y - ay) * uy) / (ux * ux + uy * uy)
    t = min(max(t, 0.0), 1.0)
    return math.hypot(ax + t * ux - x, ay + t * uy - y)


@njit(cache=True)
def winding(segments, x, y):  # type: ignore[no-untyped-def]  # kernel
    """Winding number of all segments about a point (Sunday 2001): -1 in free space, >= 0 in solids."""
    number = 0
    for m in range(segments.shape[0]):
        ax, ay, bx, by = segments[m]
        if (ay <= y) == (by <= y):
            continue
        left = (bx - ax) * (y - ay) - (x - ax) * (by - ay)
        if by > y and left > 0.0:
            number += 1
        elif by <= y and left < 0.0:
            number -= 1
    return number


@njit(cache=True)
def clearance_of(segments, x, y):  # type: ignore[no-untyped-def]  # kernel
    """Distance from a point to the solids that (M, 4) segments enclose: 0 inside, inf without any."""
    if winding(segments, x, y) > 0:
        return 0.0
    best = math.inf
    for m in range(segments.shape[0]):
        best = min(best, _distance(segments, m, x, y))
    return best


@njit(cache=True)
def fits(index, points, radius):  # type: ignore[no-untyped-def]  # kernel
    """(N,) bool: whether no segment comes nearer than ``radius`` to each of (N, 2) points."""
    result = np.empty(points.shape[0], dtype=np.bool_)
    for i in range(points.shape[0]):
        distance, _ = nearest(index, points[i, 0], points[i, 1], radius)
        result[i] = distance >= radius
    return result


@njit(cache=True)
def way_fits(index, ax, ay, bx, by, radius):  # type: ignore[no-untyped-def]  # kernel
    """Whether a disc can go straight from a to b.

    Within (distance - radius) of a place all others fit too, hence long strides; where they are at their
    shortest, a corner may reach ``_STRIDE_M``² / (8 radius) into the disc between two of them.
    """
    length = math.hypot(bx - ax, by - ay)
    along = 0.0
    while along < length:
        x, y = ax + (bx - ax) * along / length, ay + (by - ay) * along / length
        distance, _ = nearest(index, x, y, radius + _FAR_M)
        if distance < radius:
            return False
        along += max(distance - radius, _STRIDE_M)
    distance, _ = nearest(index, bx, by, radius)
    return distance >= radius
