"""The pose graph: SE(2) keyframes and constraints in gtsam's iSAM2."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import gtsam
import numpy as np
from numpy.typing import NDArray

from explore_bt.types import Pose2
from explore_bt_slam.guests import Guests, mate_of
from explore_bt_slam.point_to_line import Alignment
from explore_bt_slam.weighing import weighed

__all__ = ["Edge", "PoseGraph", "closure_edge"]

_PRIOR_SIGMAS = np.array([1e-3, 1e-3, 1e-4])
_CAUCHY_SCALE = 1.0
_UPDATES_PER_CLOSURE = 1
_LARGE_M = 0.2
_SETTLING = 10
_RECONSIDERED = 12
"""When so many closures were refused, half of those offered lately, all are weighed anew."""
_CREDIBLE = 16.3  # χ² of three degrees of freedom, 99.9 %
_COMMON = np.diag([0.02, 0.02, 0.01]) ** 2


@dataclass(frozen=True, slots=True, eq=False)
class Edge:
    """A measured relative pose between two keyframes.

    Attributes:
        a, b: keyframes, of other robots by their ``guest_key``; ``relative`` is ``T_a_b``.
        covariance: (3, 3) float64 over x, y (m²), yaw (rad²), in the axes of ``b``.
        is_closure: found by place, not by driving: goes in under a robust kernel.
    """

    a: int
    b: int
    relative: Pose2
    covariance: NDArray[np.float64]
    is_closure: bool


def closure_edge(poses: NDArray[np.float64], old: int, newest: int, found: Alignment) -> Edge:
    """A scan laid into an old place, as a constraint; a floor stands for what all matches have in common.

    Args:
        poses: (N, 3) float64 keyframe poses, ``map`` frame.
        old: the keyframe of the place.
        newest: the keyframe of the scan.
        found: where the scan of ``newest`` fits.
    """
    cos, sin = math.cos(found.pose.yaw_rad), math.sin(found.pose.yaw_rad)
    turn = np.array([[cos, sin, 0.0], [-sin, cos, 0.0], [0.0, 0.0, 1.0]])
    spread = np.linalg.inv(found.information + np.eye(3) * 1e-6)
    covariance = turn @ spread @ turn.T + np.diag([0.005, 0.005, 0.002]) ** 2
    return Edge(old, newest, Pose2(*poses[old].tolist()).between(found.pose), covariance, is_closure=True)


class PoseGraph:
    """Best poses of all keyframes under all constraints.

    Those of other robots may come in as guests: they move, and pull, like one's own, but no list of keyframes
    or constraints holds them.
    """

    def __init__(self) -> None:
        self._isam = gtsam.ISAM2(_parameters())
        self._poses = np.zeros((0, 3))
        self._edges: list[Edge] = []
        self._refused: list[Edge] = []
        self._guests: Guests[Edge] = Guests()
        self._weighed = 0
        self._lately: deque[bool] = deque(maxlen=2 * _RECONSIDERED)

    @property
    def poses(self) -> NDArray[np.float64]:
        """(N, 3) float64: x, y (m), yaw (rad) of every keyframe, ``map`` frame; do not write."""
        return self._poses

    @property
    def edges(self) -> Sequence[Edge]:
        """All constraints, in the order they came."""
        return self._edges

    @property
    def closures(self) -> int:
        """How many constraints were found by place."""
        return sum(edge.is_closure for edge in self._edges)

    def pose(self, index: int) -> Pose2:
        """A keyframe's pose; also a guest's, by its key."""
        x, y, yaw = self._poses[index] if mate_of(index) < 0 else self._guests.poses[index]
        return Pose2(float(x), float(y), float(yaw))

    def begin(self, pose: Pose2) -> None:
        """The first keyframe, held where it is."""
        factors, values = gtsam.NonlinearFactorGraph(), gtsam.Values()
        factors.add(gtsam.PriorFactorPose2(0, _gtsam(pose), gtsam.noiseModel.Diagonal.Sigmas(_PRIOR_SIGMAS)))
        values.insert(0, _gtsam(pose))
        self._isam.update(factors, values)
        self._poses = pose.as_array()[None, :]

    def extend(self, edge: Edge) -> None:
        """A new keyframe ``edge.b``, the next number, reached from ``edge.a``."""
        pose = self.pose(edge.a).compose(edge.relative)
        factors, values = gtsam.NonlinearFactorGraph(), gtsam.Values()
        factors.add(_factor(edge, is_robust=False))
        values.insert(edge.b, _gtsam(pose))
        self._isam.update(factors, values)
        self._edges.append(edge)
        self._poses = np.vstack((self._poses, pose.as_array()))

    def restore(self, poses: NDArray[np.float64], edges: Sequence[Edge]) -> None:
        """A saved graph: all keyframes and constraints at once."""
        factors, values = self._whole(poses, edges)
        self._isam = gtsam.ISAM2(_parameters())
        self._isam.update(factors, values)
        self._edges = list(edges)
        self._poses = poses.copy()

    def receive(self, poses: Mapping[int, Pose2], edges: Sequence[Edge]) -> None:
        """Guests that have not been here before, tied to the graph by ``edges``, and more about them."""
        self._guests.admit(poses, edges)
        self._settle()

    def follow(self, poses: Mapping[int, Pose2], steps: Sequence[Edge]) -> None:
        """More keyframes of a guest that is here, each reached by a step; cheap."""
        factors, values = gtsam.NonlinearFactorGraph(), gtsam.Values()
        for key, pose in poses.items():
            values.insert(key, _gtsam(pose))
        for edge in steps:
            factors.add(_factor(edge, is_robust=False))
        self._isam.update(factors, values)
        self._guests.admit(poses, steps)

    def tie(self, edges: Sequence[Edge]) -> list[Edge]:
        """Put in closures of guests that the graph finds credible, and return them."""
        taken = [edge for edge in edges if self.surprise(edge) <= _CREDIBLE]
        if taken:
            self._take(taken)
        return taken

    def loosen(self, edges: Sequence[Edge]) -> None:
        """Take constraints of guests out again."""
        going = {id(edge) for edge in edges}
        self._guests.dismiss(lambda edge: id(edge) in going)
        self._settle()

    def send_off(self, mate: int) -> None:
        """Take all keyframes of a guest out again, and whatever they have done."""
        self._guests.dismiss(lambda edge: mate in (mate_of(edge.a), mate_of(edge.b)), mate)
        self._settle()

    def _settle(self) -> None:
        """After a large move iSAM's one step is not enough: Levenberg–Marquardt over everything."""
        factors, values = self._whole(self._poses, self._edges)
        parameters = gtsam.LevenbergMarquardtParams()
        parameters.setMaxIterations(_SETTLING)
        settled = gtsam.LevenbergMarquardtOptimizer(factors, values, parameters).optimize()
        self.restore(self._own(np.asarray(gtsam.utilities.extractPose2(settled))), self._edges)

    def _own(self, rows: NDArray[np.float64]) -> NDArray[np.float64]:
        """One's own of all poses in the order of their keys; the guests are moved along."""
        self._guests.move(rows[len(self._poses) :])
        return rows[: len(self._poses)].copy()

    def _whole(
        self, poses: NDArray[np.float64], edges: Sequence[Edge]
    ) -> tuple[gtsam.NonlinearFactorGraph, gtsam.Values]:
        factors, values = gtsam.NonlinearFactorGraph(), gtsam.Values()
        first = Pose2(*map(float, poses[0]))
        factors.add(gtsam.PriorFactorPose2(0, _gtsam(first), gtsam.noiseModel.Diagonal.Sigmas(_PRIOR_SIGMAS)))
        for index, pose in enumerate(poses):
            values.insert(index, gtsam.Pose2(*map(float, pose)))
        for key, pose in self._guests.poses.items():
            values.insert(key, gtsam.Pose2(*map(float, pose)))
        for edge in (*edges, *self._guests.edges):
            factors.add(_factor(edge, edge.is_closure))
        return factors, values

    def close(self, edges: Sequence[Edge]) -> list[Edge]:
        """Put in those closures that the graph finds credible.

        A closure goes in without a kernel first, so that it takes the drift out at once (under a robust
        kernel a true closure of a large drift looks like an outlier), and gets the kernel once it fits.

        Where one false closure has made the graph sure of something wrong, it refuses all true ones after it;
        when that happens in a row, all closures ever offered are weighed against one another.

        Returns:
            The closures that went in.
        """
        is_credible = [self.surprise(edge) <= _CREDIBLE for edge in edges]
        taken = [edge for edge, credible in zip(edges, is_credible, strict=True) if credible]
        self._refused += [edge for edge, credible in zip(edges, is_credible, strict=True) if not credible]
        self._lately.extend(is_credible)
        if taken:
            self._take(taken)
        is_suspect = self._lately.count(False) >= _RECONSIDERED
        if is_suspect and len(self._refused) - self._weighed >= _RECONSIDERED:
            taken += self._reconsider()
        return taken

    def _reconsider(self) -> list[Edge]:
        """All closures anew by graduated non-convexity; believed if more of them agree than do now.

        Returns:
            Closures that had been refused and are now in.
        """
        before = self.closures
        steps = [edge for edge in self._edges if not edge.is_closure]
        offered = [edge for edge in self._edges if edge.is_closure] + self._refused
        factors, values = self._whole(self._poses, steps)
        rows, is_kept = weighed(factors, values, [_factor(edge, is_robust=False) for edge in offered])
        kept = [edge for edge, keeps in zip(offered, is_kept, strict=True) if keeps]
        self._weighed = len(self._refused)
        if len(kept) <= before:
            return []
        self._refused = [edge for edge, keeps in zip(offered, is_kept, strict=True) if not keeps]
        self._weighed = len(self._refused)
        self._lately.clear()
        self.restore(self._own(rows), steps + kept)
        return [edge for edge, keeps in zip(offered[before:], is_kept[before:], strict=True) if keeps]

    def _take(self, taken: Sequence[Edge]) -> None:
        indices = self._add(taken, is_robust=False)
        for _ in range(_UPDATES_PER_CLOSURE):
            self._isam.update()
        self._add(taken, is_robust=True, replaced=indices)
        before, self._poses = self._poses, self._extract()
        self._edges.extend(edge for edge in taken if not _is_guests(edge))
        self._guests.admit({}, [edge for edge in taken if _is_guests(edge)])
        if np.hypot(*(self._poses - before)[:, :2].T).max() > _LARGE_M:
            self._settle()

    def surprise(self, edge: Edge) -> float:
        """Squared Mahalanobis distance of a new constraint from what the graph believes.

        The innovation test with the exact joint marginal of both keyframes, widened by what neighbouring
        matches have in common.
        """
        now = self.pose(edge.a).between(self.pose(edge.b))
        joint = self._isam.jointMarginalCovariance([edge.a, edge.b])
        back = -np.asarray(_gtsam(now.inverse()).AdjointMap())
        cross = back @ np.asarray(joint.at(edge.a, edge.b))
        spread = back @ np.asarray(joint.at(edge.a, edge.a)) @ back.T + cross + cross.T
        spread = spread + np.asarray(joint.at(edge.b, edge.b)) + edge.covariance + _COMMON
        off = now.between(edge.relative).as_array()
        return float(off @ np.linalg.solve(spread, off))

    def covariance(self, index: int) -> NDArray[np.float64]:
        """(3, 3) float64 marginal of a keyframe, ``map`` axes."""
        local = np.asarray(self._isam.marginalCovariance(index))
        yaw = float(self._poses[index, 2])
        turn = np.eye(3)
        turn[:2, :2] = [[math.cos(yaw), -math.sin(yaw)], [math.sin(yaw), math.cos(yaw)]]
        return turn @ local @ turn.T

    def _extract(self) -> NDArray[np.float64]:
        return self._own(np.asarray(gtsam.utilities.extractPose2(self._isam.calculateEstimate())))

    def _add(self, edges: Sequence[Edge], is_robust: bool, replaced: Sequence[int] = ()) -> list[int]:
        factors = gtsam.NonlinearFactorGraph()
        for edge in edges:
            factors.add(_factor(edge, is_robust))
        result = self._isam.update(factors, gtsam.Values(), list(replaced))
        return list(result.getNewFactorsIndices())


def _parameters() -> gtsam.ISAM2Params:
    parameters = gtsam.ISAM2Params()
    parameters.setRelinearizeThreshold(1e-3)
    parameters.relinearizeSkip = 1
    parameters.setFactorization("QR")  # Cholesky gives up where steps of metres and of millimetres meet
    return parameters


def _is_guests(edge: Edge) -> bool:
    return mate_of(edge.a) >= 0 or mate_of(edge.b) >= 0


def _gtsam(pose: Pose2) -> gtsam.Pose2:
    return gtsam.Pose2(pose.x, pose.y, pose.yaw_rad)


def _factor(edge: Edge, is_robust: bool) -> gtsam.BetweenFactorPose2:
    plain = gtsam.noiseModel.Gaussian.Covariance(edge.covariance)
    relative = _gtsam(edge.relative)
    if not is_robust:
        return gtsam.BetweenFactorPose2(edge.a, edge.b, relative, plain)
    kernel = gtsam.noiseModel.mEstimator.Cauchy.Create(_CAUCHY_SCALE)
    robust = gtsam.noiseModel.Robust.Create(kernel, plain)
    return gtsam.BetweenFactorPose2(edge.a, edge.b, relative, robust)
