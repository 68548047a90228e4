"""Doubtful closures wait until a second one says the same."""

from __future__ import annotations

from collections import deque

import numpy as np
from numpy.typing import NDArray

from explore_bt_slam.consistency import agree
from explore_bt_slam.pose_graph import Edge

__all__ = ["Agreement"]

_LATELY = 20


class Agreement:
    """Pairwise consistency between the closures of the last few keyframes."""

    def __init__(self) -> None:
        self._pending: deque[Edge] = deque(maxlen=_LATELY)

    def of(self, edge: Edge, poses: NDArray[np.float64], covariances: NDArray[np.float64]) -> list[Edge]:
        """A closure of the newest keyframe and the waiting ones that it confirms; else none, and it waits.

        Args:
            edge: the new closure.
            poses: (N, 3) float64 keyframe poses, ``map`` frame.
            covariances: (N, 3, 3) float64 relative to the newest keyframe.
        """
        agreeing = [
            other for other in self._pending if other.b != edge.b and agree(edge, other, poses, covariances)
        ]
        if not agreeing:
            self._pending.append(edge)
            return []
        for other in agreeing:
            self._pending.remove(other)
        return [*agreeing, edge]
