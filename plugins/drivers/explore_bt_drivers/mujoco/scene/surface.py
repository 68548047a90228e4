"""Flat pieces of surface in space, each with its own piece of texture."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from explore_bt_drivers.mujoco.scene.tints import Tint

__all__ = ["Surface", "caps", "joined", "sides", "slab"]

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Surface:
    """Triangles; no two patches share a vertex.

    Attributes:
        vertices: (V, 3) float64, metres, ``map`` frame.
        faces: (F, 3) int64 vertices, counter-clockwise from outside.
        patches: (V,) int64, the patch of each vertex.
        local: (V, 2) float64, metres from the lower left corner of its patch.
        sizes: (P, 2) float64, metres, width and height of each patch.
        tints: (P, 3) float64, 0 to 1: red, green, blue of each.
    """

    vertices: Floats
    faces: NDArray[np.int64]
    patches: NDArray[np.int64]
    local: Floats
    sizes: Floats
    tints: Floats


def sides(edges: Floats, low_m: float, high_m: float, tint: Tint) -> Surface:
    """Upright rectangles over (N, 4) edges (x, y of begin and end, metres) with solid on their left."""
    count = len(edges)
    lengths = np.hypot(edges[:, 2] - edges[:, 0], edges[:, 3] - edges[:, 1])
    begins, ends = edges[:, :2], edges[:, 2:]
    vertices = np.empty((count, 4, 3))
    for corner, (place, height) in enumerate(
        ((begins, low_m), (ends, low_m), (ends, high_m), (begins, high_m))
    ):
        vertices[:, corner, :2], vertices[:, corner, 2] = place, height
    local = np.zeros((count, 4, 2))
    local[:, 1:3, 0] = lengths[:, None]
    local[:, 2:, 1] = high_m - low_m
    sizes = np.column_stack((lengths, np.full(count, high_m - low_m)))
    return _quads(vertices.reshape(-1, 3), local.reshape(-1, 2), sizes, tint)


def slab(corners: Floats, tint: Tint) -> Surface:
    """One flat quadrilateral: (4, 3) corners, metres, counter-clockwise from outside."""
    along = (corners[1] - corners[0]) / np.linalg.norm(corners[1] - corners[0])
    normal = np.cross(corners[1] - corners[0], corners[3] - corners[0])
    across = np.cross(normal / np.linalg.norm(normal), along)
    local = (corners - corners[0]) @ np.column_stack((along, across))
    local -= local.min(axis=0)
    return _quads(corners, local, local.max(axis=0)[None, :], tint)


def caps(triangles: Floats, height_m: float, tint: Tint, *, faces_up: bool) -> Surface:
    """One level patch of (T, 3, 2) triangles, metres, at a height."""
    flat = triangles.reshape(-1, 2)
    faces = np.arange(len(flat), dtype=np.int64).reshape(-1, 3)
    a, b, c = (triangles[:, k] for k in range(3))
    is_up = (b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) > (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0])
    faces[is_up != faces_up] = faces[is_up != faces_up][:, ::-1]
    low = flat.min(axis=0)
    return Surface(
        np.column_stack((flat, np.full(len(flat), height_m))),
        faces,
        np.zeros(len(flat), dtype=np.int64),
        flat - low,
        (flat.max(axis=0) - low)[None, :],
        np.asarray(tint, dtype=np.float64)[None, :],
    )


def joined(surfaces: Sequence[Surface]) -> Surface:
    """All of them as one."""
    vertices = np.cumsum([0, *(len(surface.vertices) for surface in surfaces)])
    patches = np.cumsum([0, *(len(surface.sizes) for surface in surfaces)])
    empty = (
        np.zeros((0, 3)),
        np.zeros((0, 3), np.int64),
        np.zeros(0, np.int64),
        *(np.zeros((0, n)) for n in (2, 2, 3)),
    )
    none = Surface(*empty)  # type: ignore[arg-type]  # the six arrays, in order
    parts = [none, *surfaces]
    return Surface(
        np.concatenate([part.vertices for part in parts]),
        np.concatenate(
            [none.faces, *(s.faces + first for s, first in zip(surfaces, vertices, strict=False))]
        ),
        np.concatenate(
            [none.patches, *(s.patches + first for s, first in zip(surfaces, patches, strict=False))]
        ),
        np.concatenate([part.local for part in parts]),
        np.concatenate([part.sizes for part in parts]),
        np.concatenate([part.tints for part in parts]),
    )


def _quads(vertices: Floats, local: Floats, sizes: Floats, tint: Tint) -> Surface:
    """Patches of four vertices each, counter-clockwise from outside."""
    count = len(sizes)
    halves = np.array([(0, 1, 2), (0, 2, 3)], dtype=np.int64)
    faces = (4 * np.arange(count, dtype=np.int64)[:, None, None] + halves).reshape(-1, 3)
    tints = np.tile(np.asarray(tint, dtype=np.float64), (count, 1))
    return Surface(vertices, faces, np.repeat(np.arange(count, dtype=np.int64), 4), local, sizes, tints)
