"""Doubtful closures wait until a second one says the same."""

from __future__ import annotations

from collections import deque

import numpy as np
from numpy.typing import NDArray

from explore_bt.types import Pose2
from explore_bt_slam.pose_graph import Edge

__all__ = ["Agreement"]

_LATELY = 20
_SLACK = np.diag([0.05, 0.05, 0.02]) ** 2


class Agreement:
    """Pairwise consistency (Mangelson et al. 2018) between the closures of the last few keyframes.

    Args:
        gate: χ² of three degrees of freedom that two of them may be apart.
    """

    def __init__(self, gate: float) -> None:
        self._gate = gate
        self._pending: deque[Edge] = deque(maxlen=_LATELY)

    def of(self, edge: Edge, poses: NDArray[np.float64], covariances: NDArray[np.float64]) -> list[Edge]:
        """A closure of the newest keyframe and the waiting ones that it confirms; else none, and it waits.

        Args:
            edge: the new closure.
            poses: (N, 3) float64 keyframe poses, ``map`` frame.
            covariances: (N, 3, 3) float64 relative to the newest keyframe.
        """
        agreeing = [other for other in self._pending if self._agree(edge, other, poses, covariances)]
        if not agreeing:
            self._pending.append(edge)
            return []
        for other in agreeing:
            self._pending.remove(other)
        return [*agreeing, edge]

    def _agree(
        self, edge: Edge, other: Edge, poses: NDArray[np.float64], covariances: NDArray[np.float64]
    ) -> bool:
        """Around the loop a → b → b' → a' → a the known motions and the two closures cancel."""
        if other.b == edge.b:
            return False
        a, b, b2, a2 = (Pose2(*poses[index].tolist()) for index in (edge.a, edge.b, other.b, other.a))
        loop = (
            edge.relative.compose(b.between(b2)).compose(other.relative.inverse()).compose(a2.between(a))
        ).as_array()
        spread = covariances[other.b] + edge.covariance + other.covariance + _SLACK
        return float(loop @ np.linalg.solve(spread, loop)) <= self._gate
