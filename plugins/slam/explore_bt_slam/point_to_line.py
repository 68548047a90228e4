"""Point-to-line refinement with a prior: the last centimetre, and how well the lidar pins each direction."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray

from explore_bt.types import Pose2
from explore_bt_slam.arrays import Floats, Ints32
from explore_bt_slam.surfels import SurfelMap

__all__ = ["Alignment", "align"]

_RADIUS_M = 0.15
_ITERATIONS = 12
_KERNEL_M = 0.05
_GOOD_RESIDUAL_M = 0.03


@dataclass(frozen=True, slots=True, eq=False)
class Alignment:
    """A scan laid into a map.

    Attributes:
        pose: ``T_map_base``.
        information: (3, 3) float64, map axes: what the lidar alone says about x, y (1/m²), yaw (1/rad²).
        overlap: share [0, 1] of the scan's points that found their line.
        residual_m: root mean square distance of those points to their lines.
    """

    pose: Pose2
    information: NDArray[np.float64]
    overlap: float
    residual_m: float

    @property
    def fitness(self) -> float:
        """Overlap, less where the points that match do so badly: [0, 1]."""
        return self.overlap / (1.0 + (self.residual_m / _GOOD_RESIDUAL_M) ** 2)

    @property
    def weakest_sigma_m(self) -> float:
        """Standard deviation along the direction that the lidar pins least; inf where not at all."""
        along = float(np.linalg.eigvalsh(_position_information(self.information))[0])
        return float("inf") if along <= 1e-9 else along**-0.5


def align(
    points: NDArray[np.float64],
    normals: NDArray[np.float64],
    surfels: SurfelMap,
    guess: Pose2,
    prior: Pose2,
    prior_information: NDArray[np.float64],
    sigma_m: float = 0.03,
) -> Alignment:
    """Gauss–Newton over point-to-line distances under a Geman–McClure kernel, tied to a prior.

    Directions that only the noise of the normals speaks for are left to the prior (solution remapping,
    Zhang, Kaess and Singh 2016).

    Args:
        points: (N, 2) float64, base frame.
        normals: (N, 2) float64, base frame, see ``normals_of``.
        surfels: the map.
        guess: where to begin.
        prior: the predicted pose.
        prior_information: (3, 3) float64, map axes: how much the prediction is worth.
        sigma_m: what one point is worth; more than the sensor's noise, since errors go together.
    """
    pose, information, matched, squares, usable = _align(
        points,
        normals,
        surfels.points,
        surfels.normals,
        surfels.index,
        surfels.origin_xy,
        surfels.cell_m,
        guess.as_array(),
        prior.as_array(),
        prior_information,
        sigma_m,
        _RADIUS_M,
        _ITERATIONS,
    )
    return Alignment(
        Pose2(float(pose[0]), float(pose[1]), float(pose[2])),
        information,
        matched / max(usable, 1),
        float(np.sqrt(squares / max(matched, 1))),
    )


@njit(cache=True)
def _position_information(H: Floats) -> Floats:
    """(2, 2): information about the position once the yaw is free (Schur complement)."""
    out = H[:2, :2].copy()
    if H[2, 2] > 1e-9:
        for i in range(2):
            for j in range(2):
                out[i, j] -= H[i, 2] * H[2, j] / H[2, 2]
    return out


@njit(cache=True)
def _nearest(
    x: float,
    y: float,
    nx: float,
    ny: float,
    points: Floats,
    normals: Floats,
    index: Ints32,
    origin: Floats,
    cell: float,
    radius: float,
) -> int:
    """The nearest line piece that looks the same way, or -1."""
    reach = int(np.ceil(radius / cell))
    row, col = int(np.floor((y - origin[1]) / cell)), int(np.floor((x - origin[0]) / cell))
    best, best_d2 = -1, radius * radius
    for r in range(max(row - reach, 0), min(row + reach + 1, index.shape[0])):
        for c in range(max(col - reach, 0), min(col + reach + 1, index.shape[1])):
            for side in range(index.shape[2]):
                k = index[r, c, side]
                if k < 0 or normals[k, 0] * nx + normals[k, 1] * ny < 0.7:
                    continue
                d2 = (points[k, 0] - x) ** 2 + (points[k, 1] - y) ** 2
                if d2 < best_d2:
                    best, best_d2 = k, d2
    return best


@njit(cache=True)
def _align(
    points: Floats,
    normals: Floats,
    map_points: Floats,
    map_normals: Floats,
    index: Ints32,
    origin: Floats,
    cell: float,
    guess: Floats,
    prior: Floats,
    prior_H: Floats,
    sigma: float,
    radius: float,
    iterations: int,
) -> tuple[Floats, Floats, int, float, int]:
    pose = guess.copy()
    H, g = np.zeros((3, 3)), np.zeros(3)
    matched, squares, usable = 0, 0.0, 0
    for _ in range(iterations):
        H[:, :], g[:] = 0.0, 0.0
        matched, squares, usable = 0, 0.0, 0
        weights = 0.0
        for i in range(points.shape[0]):
            if normals[i, 0] == 0.0 and normals[i, 1] == 0.0:
                continue
            usable += 1
            r, w = _add_point(
                H, g, points[i], normals[i], map_points, map_normals, index, origin, cell, pose, sigma, radius
            )
            if w > 0.0:
                matched, squares, weights = matched + 1, squares + r * r, weights + w
        _leave_noise_out(H, g, weights)
        off = pose - prior
        off[2] = (off[2] + np.pi) % (2.0 * np.pi) - np.pi
        step = np.linalg.solve(H + prior_H + np.eye(3) * 1e-9, g + prior_H @ off)
        pose -= step
        if np.hypot(step[0], step[1]) < 1e-5 and abs(step[2]) < 1e-5:
            break
    return pose, H, matched, squares, usable


@njit(cache=True)
def _add_point(
    H: Floats,
    g: Floats,
    point: Floats,
    normal: Floats,
    map_points: Floats,
    map_normals: Floats,
    index: Ints32,
    origin: Floats,
    cell: float,
    pose: Floats,
    sigma: float,
    radius: float,
) -> tuple[float, float]:
    """Add one point to the normal equations; returns its distance and weight, 0 without a line."""
    cos, sin = np.cos(pose[2]), np.sin(pose[2])
    qx, qy = cos * point[0] - sin * point[1], sin * point[0] + cos * point[1]
    nx, ny = cos * normal[0] - sin * normal[1], sin * normal[0] + cos * normal[1]
    x, y = pose[0] + qx, pose[1] + qy
    k = _nearest(x, y, nx, ny, map_points, map_normals, index, origin, cell, radius)
    if k < 0:
        return 0.0, 0.0
    mx, my = map_normals[k, 0], map_normals[k, 1]
    r = mx * (x - map_points[k, 0]) + my * (y - map_points[k, 1])
    w = 1.0 / (1.0 + (r / _KERNEL_M) ** 2) ** 2 / sigma**2
    J = (mx, my, my * qx - mx * qy)
    for a in range(3):
        g[a] += w * J[a] * r
        for b in range(3):
            H[a, b] += w * J[a] * J[b]
    return r, w


@njit(cache=True)
def _leave_noise_out(H: Floats, g: Floats, weight_sum: float) -> None:
    """Take off the information that normals wrong by some 3° would feign along a plain wall."""
    if weight_sum <= 0.0:
        return
    floor = 0.05**2 * weight_sum
    S = _position_information(H)
    middle = 0.5 * (S[0, 0] + S[1, 1])
    spread = np.hypot(0.5 * (S[0, 0] - S[1, 1]), S[0, 1])
    small = middle - spread
    if small > 4.0 * floor:
        return
    angle = 0.5 * np.arctan2(2.0 * S[0, 1], S[0, 0] - S[1, 1]) + 0.5 * np.pi
    v = (np.cos(angle), np.sin(angle))
    # between 1 and 4 times the floor the information fades in, so nothing switches abruptly
    kept = max(small - floor, 0.0) / 0.75
    share = 1.0 - kept / max(small, 1e-12)
    # u is v with the yaw that goes with it for free: H u = small · v
    yaw = 0.0 if H[2, 2] <= 1e-9 else -(H[2, 0] * v[0] + H[2, 1] * v[1]) / H[2, 2]
    gu = g[0] * v[0] + g[1] * v[1] + g[2] * yaw
    for a in range(2):
        g[a] -= share * gu * v[a]
        for b in range(2):
            H[a, b] -= share * small * v[a] * v[b]
