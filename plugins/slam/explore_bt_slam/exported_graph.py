"""The pose graph as exporters take it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from explore_bt.types import PoseGraph2
from explore_bt_slam.pose_graph import Edge

__all__ = ["graph_of"]


def graph_of(poses: NDArray[np.float64], edges: Sequence[Edge]) -> PoseGraph2:
    """(N, 3) poses of the keyframes, and the edges' covariances inverted."""
    covariances = np.array([edge.covariance for edge in edges]).reshape(-1, 3, 3)
    return PoseGraph2(
        poses,
        np.array([(edge.a, edge.b) for edge in edges], dtype=np.int64).reshape(-1, 2),
        np.array([edge.relative.as_array() for edge in edges], dtype=np.float64).reshape(-1, 3),
        np.asarray(np.linalg.inv(covariances)),
    )
