"""Solids as surfaces to be seen, and as convex bodies to be run into."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from itertools import groupby

import numpy as np
import shapely
from numpy.typing import NDArray

from explore_bt_drivers.mujoco.scene.surface import Surface, caps, sides
from explore_bt_drivers.mujoco.scene.tints import Tint
from explore_bt_drivers.world import Solid

__all__ = ["convex_parts", "surfaces_of"]

Floats = NDArray[np.float64]

_GRID_M = 1e-6
"""Corners nearer to one another than this are one: walls that meet do so to rounding only."""


def surfaces_of(solids: Sequence[Solid], tint: Callable[[], Tint]) -> Iterator[Surface]:
    """The outer surface of solids of one material; what overlaps at equal heights has one surface.

    Without that, two walls that lie upon each other would flicker in the camera's eye.
    """

    def heights(solid: Solid) -> tuple[float, float]:
        return (solid.low_m, solid.height_m)

    for (low_m, high_m), group in groupby(sorted(solids, key=heights), key=heights):
        outlines = [shapely.Polygon(solid.corners) for solid in group]
        for part in shapely.get_parts(shapely.union_all(outlines, grid_size=_GRID_M)):
            colour = tint()
            for edges in _walls(part):
                yield sides(edges, low_m, high_m, colour)
            triangles = _triangles(part)
            yield caps(triangles, high_m, colour, faces_up=True)
            if low_m > 0.0:
                yield caps(triangles, low_m, colour, faces_up=False)


def convex_parts(solid: Solid) -> list[Floats]:
    """(N, 2) counter-clockwise corners of convex polygons that make up its outline."""
    outline = shapely.Polygon(solid.corners)
    if outline.convex_hull.area - outline.area <= _GRID_M * outline.length:
        return [solid.corners]
    return list(_triangles(outline))


def _walls(part: shapely.Polygon) -> Iterator[Floats]:
    """(N, 4) edges round each ring, solid on their left."""
    whole = shapely.orient_polygons(part)
    for ring in (whole.exterior, *whole.interiors):
        corners = shapely.get_coordinates(ring)
        yield np.hstack((corners[:-1], corners[1:]))


def _triangles(part: shapely.Polygon) -> Floats:
    """(T, 3, 2) float64 of a polygon, with holes or without."""
    pieces = shapely.get_parts(shapely.constrained_delaunay_triangles(part))
    corners = shapely.get_coordinates(pieces).reshape(-1, 4, 2)[:, :3]
    a, b, c = (corners[:, k] for k in range(3))
    is_left = (b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) > (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0])
    corners[~is_left] = corners[~is_left][:, ::-1]
    return np.asarray(corners, dtype=np.float64)
