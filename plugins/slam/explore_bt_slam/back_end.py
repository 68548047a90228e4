"""Keyframes, their graph, and the loops it closes."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from explore_bt.types import Pose2
from explore_bt_slam.camera_closures import CameraClosures
from explore_bt_slam.closures import ClosureFinder
from explore_bt_slam.far_closures import FarClosureFinder
from explore_bt_slam.graph_distance import relative_covariances
from explore_bt_slam.keyframes import Keyframe
from explore_bt_slam.local_map import gather_points, gather_surfels, trusted_neighbours
from explore_bt_slam.pose_graph import Edge, PoseGraph
from explore_bt_slam.relocaliser import Relocaliser
from explore_bt_slam.sight import Sight
from explore_bt_slam.surfels import SurfelMap, normals_of
from explore_bt_slam.sweep import Sweep

__all__ = ["BackEnd"]

_NEIGHBOURS_M = 6.0
_TRUSTED_SIGMA_M = 0.07
_EDGE_FLOOR = np.diag([0.0075, 0.0075, 0.0045]) ** 2
_EDGE_MOST = 25.0
"""Largest variance of a step between keyframes, m² and rad²: in a hall without walls in range the filter's
own grows without bound. Less would make the graph too sure of a blind stretch to close a loop over it."""


class BackEnd:
    """Where every keyframe is.

    Args:
        loop_closures: whether to look for them by lidar.

    Attributes:
        looks: what places look like, and the loops that this closes.
    """

    def __init__(self, loop_closures: bool) -> None:
        self._loop_closures = loop_closures
        self._keyframes: list[Keyframe] = []
        self._graph = PoseGraph()
        self._finder = ClosureFinder()
        self._far_finder = FarClosureFinder()
        self._relocaliser = Relocaliser(self._far_finder)
        self._closures = 0
        self._covariances = np.zeros((0, 3, 3))
        self.looks = CameraClosures()

    @property
    def keyframes(self) -> Sequence[Keyframe]:
        """All of them, in the order they came."""
        return self._keyframes

    @property
    def poses(self) -> NDArray[np.float64]:
        """(N, 3) float64 of every keyframe, ``map`` frame."""
        return self._graph.poses

    @property
    def edges(self) -> Sequence[Edge]:
        """All constraints."""
        return self._graph.edges

    @property
    def graph(self) -> PoseGraph:
        """For whoever brings guests into it; everybody else asks for ``poses`` and ``edges``."""
        return self._graph

    @property
    def closures(self) -> int:
        """How many constraints were found by place."""
        return self._closures

    def pose(self, keyframe: int) -> Pose2:
        """Where a keyframe is."""
        return self._graph.pose(keyframe)

    def covariance(self, keyframe: int) -> NDArray[np.float64]:
        """(3, 3) float64 marginal of a keyframe, ``map`` axes."""
        return self._graph.covariance(keyframe)

    def begin(self, sweep: Sweep, pose: Pose2) -> int:
        """The first keyframe."""
        self._graph.begin(pose)
        return self._keep(sweep, 0.0)

    def extend(
        self,
        sweep: Sweep,
        since: int,
        relative: Pose2,
        covariance: NDArray[np.float64],
        sight: Sight | None = None,
    ) -> int:
        """A new keyframe at ``relative`` to keyframe ``since``, and the loops that it closes.

        Args:
            sweep: what was seen from it.
            since: the keyframe that it was reached from.
            relative: ``T_since_new``.
            covariance: (3, 3) float64 of ``relative``, axes of the new keyframe.
            sight: what the camera saw from it.
        """
        newest = len(self._keyframes)
        self._graph.extend(Edge(since, newest, relative, _bounded(covariance), is_closure=False))
        driven_m = self._keyframes[-1].driven_m + float(np.hypot(relative.x, relative.y))
        self._keep(sweep, driven_m)
        self._measure(newest)
        self._close_loops(newest, sight)
        return newest

    def surroundings(self, keyframe: int) -> tuple[NDArray[np.float64], SurfelMap]:
        """The local map about a keyframe: (N, 2) points in the ``map`` frame, and line pieces."""
        if self._covariances.shape[0] != len(self._keyframes):
            self._measure(keyframe)
        chosen = trusted_neighbours(self.poses, self._covariances, keyframe, _NEIGHBOURS_M, _TRUSTED_SIGMA_M)
        half_side_m = self._keyframes[keyframe].reach_m + 2.0
        surfels = gather_surfels(self._keyframes, self.poses, chosen, self.pose(keyframe).xy, half_side_m)
        return gather_points(self._keyframes, self.poses, chosen), surfels

    def recognise(self, sweep: Sweep, believed: Pose2) -> Pose2 | None:
        """Where a lost robot is, if its scans say so clearly; called scan by scan while it is lost.

        Args:
            sweep: what it sees.
            believed: where dead reckoning puts it; only its changes count.
        """
        points = sweep.points
        scan = Keyframe(sweep.stamp_s, points, normals_of(points), 0.0)
        found = self._relocaliser.step(self._keyframes, self.poses, scan, believed)
        return None if found is None else found[1]

    def enter(self, keyframe: int) -> None:
        """The robot is at an old keyframe now; errors count from there."""
        self._relocaliser.forget()
        self._measure(keyframe)

    def restore(self, keyframes: list[Keyframe], poses: NDArray[np.float64], edges: list[Edge]) -> None:
        """A saved state."""
        self._keyframes = list(keyframes)
        self._graph.restore(poses, edges)
        self._closures = sum(edge.is_closure for edge in edges)

    def _close_loops(self, newest: int, sight: Sight | None) -> None:
        keyframes, poses, covariances = self._keyframes, self.poses, self._covariances
        found: list[Edge] = []
        if self._loop_closures:
            found = self._finder.find(keyframes, poses, covariances)
            found = found or self._far_finder.find(keyframes, poses, covariances)
        if sight is not None:
            found = [] if self.looks.contradict(sight, found, keyframes, poses) else found
            found += self.looks.find(sight, keyframes, poses, covariances)
        taken = self._graph.close(found)
        if taken:
            self._closures = self._graph.closures
            self._measure(newest)

    def _measure(self, source: int) -> None:
        self._covariances = relative_covariances(self.poses, self.edges, source)

    def _keep(self, sweep: Sweep, driven_m: float) -> int:
        points = sweep.points
        self._keyframes.append(Keyframe(sweep.stamp_s, points, normals_of(points), driven_m))
        return len(self._keyframes) - 1


def _bounded(covariance: NDArray[np.float64]) -> NDArray[np.float64]:
    """(3, 3) float64: the covariance with its floor, no direction less certain than the graph can take."""
    if not np.isfinite(covariance).all():
        return np.eye(3) * _EDGE_MOST
    variances, directions = np.linalg.eigh(covariance + _EDGE_FLOOR)
    return np.asarray((directions * np.clip(variances, _EDGE_FLOOR.min(), _EDGE_MOST)) @ directions.T)
