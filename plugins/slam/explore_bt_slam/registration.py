"""The registration front end: kiss-icp, with its configuration in our hands."""

from __future__ import annotations

import math

import numpy as np
from kiss_icp.mapping import VoxelHashMap
from kiss_icp.registration import Registration
from kiss_icp.voxelization import voxel_down_sample
from numpy.typing import NDArray

from explore_bt.types import Pose2

__all__ = ["KissRegistration"]


class KissRegistration:
    """kiss-icp's point-to-point registration of flat scans, lifted to z = 0.

    ``KISSConfig`` is not used: it would read ``kiss_icp_*`` from the environment. One thread, so that
    the same scans give the same bits.

    Args:
        voxel_m: side of a map voxel; scans are thinned to 1.5 times that, as kiss-icp does.
        distance_m: farthest correspondence.
    """

    def __init__(self, voxel_m: float, distance_m: float = 0.3) -> None:
        self._voxel_m = voxel_m
        self._distance_m = distance_m
        self._map = self._empty_map()
        self._registration = Registration(
            max_num_iterations=30, convergence_criterion=1e-3, max_num_threads=1
        )

    def rebuild(self, points: NDArray[np.float64]) -> None:
        """Begin a new map of (N, 2) float64 points, metres, ``map`` frame."""
        self._map = self._empty_map()
        if points.shape[0]:
            self._map.add_points(_lifted(points))

    def align(self, points: NDArray[np.float64], guess: Pose2) -> Pose2:
        """``T_map_base`` that lays (N, 2) points of the base frame onto the map."""
        if points.shape[0] < 3 or self._map.empty():
            return guess
        thin = voxel_down_sample(_lifted(points), self._voxel_m * 1.5)
        matrix = self._registration.align_points_to_map(
            points=thin,
            voxel_map=self._map,
            initial_guess=_matrix(guess),
            max_correspondance_distance=self._distance_m,
            kernel=self._distance_m / 3.0,
        )
        found = Pose2(
            float(matrix[0, 3]), float(matrix[1, 3]), math.atan2(float(matrix[1, 0]), float(matrix[0, 0]))
        )
        return found if all(map(math.isfinite, (found.x, found.y, found.yaw_rad))) else guess

    def _empty_map(self) -> VoxelHashMap:
        return VoxelHashMap(voxel_size=self._voxel_m, max_distance=1e6, max_points_per_voxel=20)


def _lifted(points: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.column_stack((points, np.zeros(points.shape[0])))


def _matrix(pose: Pose2) -> NDArray[np.float64]:
    matrix = np.eye(4)
    cos, sin = math.cos(pose.yaw_rad), math.sin(pose.yaw_rad)
    matrix[:2, :2] = [[cos, -sin], [sin, cos]]
    matrix[:2, 3] = pose.xy
    return matrix
