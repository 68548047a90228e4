"""A local map of short line pieces: mean point and normal of what was seen in a cell from one side."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from explore_bt.types import Pose2
from explore_bt_slam.arrays import Floats, Ints32

__all__ = ["SurfelMap", "normals_of"]

_SIDES = 4  # normals are kept apart by quadrant, so the two faces of a thin wall never mix


class SurfelMap:
    """Line pieces on a grid about a centre.

    Attributes:
        points, normals: (N, 2) float64, metres, ``map`` frame; normals look to where they were seen from.
        index: (rows, cols, 4) int32: line piece of a cell and quadrant, -1 for none.
        origin_xy, cell_m: lower left corner, and the side of a cell.
    """

    def __init__(self, centre_xy: tuple[float, float], half_side_m: float, cell_m: float = 0.05) -> None:
        side = int(np.ceil(2.0 * half_side_m / cell_m))
        self.cell_m = cell_m
        self.origin_xy = np.array([centre_xy[0] - half_side_m, centre_xy[1] - half_side_m])
        self.index = np.full((side, side, _SIDES), -1, dtype=np.int32)
        self._sums = np.zeros((1024, 5))
        self._count = 0

    @property
    def points(self) -> NDArray[np.float64]:
        """(N, 2) float64: mean of what was seen."""
        used = self._sums[: self._count]
        return used[:, :2] / used[:, 4:]

    @property
    def normals(self) -> NDArray[np.float64]:
        """(N, 2) float64, unit length."""
        used = self._sums[: self._count, 2:4]
        return used / np.maximum(np.hypot(used[:, 0], used[:, 1]), 1e-12)[:, None]

    def count_near(self, xy: tuple[float, float], radius_m: float) -> int:
        """How many line pieces lie within a radius."""
        off = self.points - np.array(xy)
        return int(np.count_nonzero(np.hypot(off[:, 0], off[:, 1]) <= radius_m))

    def share_known(self, points: NDArray[np.float64], radius_m: float) -> float:
        """Share [0, 1] of (N, 2) points, ``map`` frame, with a line piece within a radius; N >= 1."""
        if self._count == 0:
            return 0.0
        distance_m, _ = cKDTree(self.points).query(points, distance_upper_bound=radius_m)
        return float(np.isfinite(distance_m).mean())

    def add(self, points: NDArray[np.float64], normals: NDArray[np.float64], pose: Pose2) -> None:
        """Put in a scan seen from ``pose``: (M, 2) points and normals in its base frame."""
        while self._count + points.shape[0] > self._sums.shape[0]:
            self._sums = np.vstack((self._sums, np.zeros_like(self._sums)))
        self._count = _add(
            self._sums,
            self.index,
            self._count,
            points,
            normals,
            pose.as_array(),
            self.origin_xy,
            self.cell_m,
        )


@njit(cache=True)
def _add(
    sums: Floats,
    index: Ints32,
    count: int,
    points: Floats,
    normals: Floats,
    pose: Floats,
    origin: Floats,
    cell: float,
) -> int:
    cos, sin = np.cos(pose[2]), np.sin(pose[2])
    for i in range(points.shape[0]):
        nx = cos * normals[i, 0] - sin * normals[i, 1]
        ny = sin * normals[i, 0] + cos * normals[i, 1]
        if nx == 0.0 and ny == 0.0:
            continue
        x = pose[0] + cos * points[i, 0] - sin * points[i, 1]
        y = pose[1] + sin * points[i, 0] + cos * points[i, 1]
        row, col = int(np.floor((y - origin[1]) / cell)), int(np.floor((x - origin[0]) / cell))
        if row < 0 or col < 0 or row >= index.shape[0] or col >= index.shape[1]:
            continue
        # quadrants are turned by 45° so that walls along the axes lie in the middle of one
        side = (1 if nx + ny > 0.0 else 0) + (2 if nx - ny > 0.0 else 0)
        k = index[row, col, side]
        if k < 0:
            k = count
            index[row, col, side] = k
            count += 1
        sums[k, 0] += x
        sums[k, 1] += y
        sums[k, 2] += nx
        sums[k, 3] += ny
        sums[k, 4] += 1.0
    return count


def normals_of(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Normals of a scan's points, from a line through neighbours along the sweep.

    Args:
        points: (N, 2) float64, metres, base frame, in beam order.

    Returns:
        (N, 2) float64: unit, towards the robot; (0, 0) where the neighbours form no line.
    """
    return np.asarray(_normals(points, 0.15, 0.4, 8, 0.03), dtype=np.float64)


@njit(cache=True)
def _normals(points: Floats, radius: float, gap: float, reach: int, thickness: float) -> Floats:
    count = points.shape[0]
    normals = np.zeros((count, 2))
    for i in range(count):
        n, sx, sy, sxx, sxy, syy = 1, 0.0, 0.0, 0.0, 0.0, 0.0
        for step in (-1, 1):
            for k in range(1, reach + 1):
                j = i + step * k
                if j < 0 or j >= count:
                    break
                dx, dy = points[j, 0] - points[i, 0], points[j, 1] - points[i, 1]
                distance = np.hypot(dx, dy)
                # the next neighbour may be farther off: beams fan out and walls are met at a slant
                if distance > (gap if k == 1 else radius):
                    break
                n += 1
                sx, sy = sx + dx, sy + dy
                sxx, sxy, syy = sxx + dx * dx, sxy + dx * dy, syy + dy * dy
        if n < 3:
            continue
        cxx, cxy, cyy = sxx / n - (sx / n) ** 2, sxy / n - sx * sy / n**2, syy / n - (sy / n) ** 2
        middle, spread = 0.5 * (cxx + cyy), np.hypot(0.5 * (cxx - cyy), cxy)
        small, large = max(middle - spread, 0.0), middle + spread
        if small > thickness**2 or large < 4.0 * small:
            continue
        angle = 0.5 * np.arctan2(2.0 * cxy, cxx - cyy) + 0.5 * np.pi
        nx, ny = np.cos(angle), np.sin(angle)
        if nx * points[i, 0] + ny * points[i, 1] > 0.0:
            nx, ny = -nx, -ny
        normals[i, 0], normals[i, 1] = nx, ny
    return normals
