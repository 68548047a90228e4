"""Solids on the floor and the shapes they are made of."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

from explore_bt.types import Pose2

__all__ = [
    "Material",
    "Solid",
    "box_corners",
    "circle_corners",
    "crossing_edges",
    "materials_of",
    "outline_edges",
    "signed_area",
]


class Material(IntEnum):
    """What a surface does to the beam of a lidar; robots and people run into all of them."""

    MATT = 0
    """Sends it back."""
    GLASS = 1
    """Lets it pass."""
    MIRROR = 2
    """Reflects it: the lidar sees the room behind the mirror, which is not there."""


@dataclass(frozen=True, slots=True, eq=False)
class Solid:
    """A prism standing on the floor, or hanging above it.

    Attributes:
        name: as people call it ("sofa", "wall of kitchen").
        corners: (N, 2) float64, metres, world frame, counter-clockwise, N >= 3, edges do not cross.
        height_m: of its top above the floor; the planar simulator takes everything for higher than its lidar.
        material: of all its faces.
        low_m: of its underside above the floor; the planar simulator leaves out what hangs.
    """

    name: str
    corners: NDArray[np.float64]
    height_m: float
    material: Material = Material.MATT
    low_m: float = 0.0


def box_corners(x0: float, y0: float, x1: float, y1: float, turn_rad: float = 0.0) -> NDArray[np.float64]:
    """(4, 2) counter-clockwise corners of a rectangle, turned about its centre."""
    x0, x1, y0, y1 = min(x0, x1), max(x0, x1), min(y0, y1), max(y0, y1)
    half_w, half_h = (x1 - x0) / 2, (y1 - y0) / 2
    square = np.array([(-half_w, -half_h), (half_w, -half_h), (half_w, half_h), (-half_w, half_h)])
    return Pose2((x0 + x1) / 2, (y0 + y1) / 2, turn_rad).apply(square)


def circle_corners(x: float, y: float, radius_m: float, count: int = 32) -> NDArray[np.float64]:
    """(count, 2) counter-clockwise corners on a circle."""
    angles = np.arange(count) * (2.0 * math.pi / count)
    return np.column_stack((x + radius_m * np.cos(angles), y + radius_m * np.sin(angles)))


def outline_edges(corners: NDArray[np.float64]) -> NDArray[np.float64]:
    """(N, 4) edges round (N, 2) corners: x, y of begin and end; solid on the left if counter-clockwise."""
    return np.hstack((corners, np.roll(corners, -1, axis=0)))


def materials_of(solids: Sequence[Solid]) -> NDArray[np.int8]:
    """(M,) int8: the material of every edge round every solid."""
    return np.repeat(
        np.array([solid.material for solid in solids], dtype=np.int8),
        [len(solid.corners) for solid in solids],
    )


def signed_area(corners: NDArray[np.float64]) -> float:
    """Area of a simple polygon, m²; positive when its corners run counter-clockwise."""
    x, y = corners.T
    return float(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1))) / 2.0


def crossing_edges(corners: NDArray[np.float64]) -> tuple[int, int] | None:
    """Two edges (by the number of their first corner, from 1) that cross each other, or None."""
    following = np.roll(corners, -1, axis=0)
    count = len(corners)
    for i in range(count):
        for j in range(i + 2, count):
            neighbours = i == 0 and j == count - 1
            if not neighbours and _cross(corners[i], following[i], corners[j], following[j]):
                return (i + 1, j + 1)
    return None


def _cross(
    a: NDArray[np.float64], b: NDArray[np.float64], c: NDArray[np.float64], d: NDArray[np.float64]
) -> bool:
    return _side(a, b, c) * _side(a, b, d) < 0.0 and _side(c, d, a) * _side(c, d, b) < 0.0


def _side(a: NDArray[np.float64], b: NDArray[np.float64], p: NDArray[np.float64]) -> float:
    return float((b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]))
