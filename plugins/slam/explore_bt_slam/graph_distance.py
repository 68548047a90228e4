"""How uncertain every keyframe is as seen from one of them, along the best way through the graph."""

from __future__ import annotations

import heapq
from collections.abc import Sequence

import numpy as np
from numba import njit
from numpy.typing import NDArray

from explore_bt_slam.arrays import Floats, Ints
from explore_bt_slam.pose_graph import Edge

__all__ = ["relative_covariances"]


def relative_covariances(
    poses: NDArray[np.float64], edges: Sequence[Edge], source: int
) -> NDArray[np.float64]:
    """Covariance of each keyframe's pose relative to ``source``, compounded along the surest path.

    Dijkstra over the trace of the position's covariance: an upper bound of the joint marginal, cheap
    enough to ask for all keyframes at once.

    Args:
        poses: (N, 3) float64 keyframe poses, ``map`` frame.
        edges: the graph's constraints.
        source: the keyframe to look from.

    Returns:
        (N, 3, 3) float64 over x, y (m²), yaw (rad²), ``map`` axes; inf where no path leads.
    """
    ends = np.array([(edge.a, edge.b) for edge in edges], dtype=np.int64).reshape(-1, 2)
    local = np.array([edge.covariance for edge in edges], dtype=np.float64).reshape(-1, 3, 3)
    return np.asarray(_spread(poses, ends, local, source), dtype=np.float64)


@njit(cache=True)
def _spread(poses: Floats, ends: Ints, local: Floats, source: int) -> Floats:
    count, edge_count = poses.shape[0], ends.shape[0]
    first = np.full(count, -1, np.int64)
    following = np.full(2 * edge_count, -1, np.int64)
    for e in range(edge_count):
        for side in range(2):
            node = ends[e, side]
            following[2 * e + side] = first[node]
            first[node] = 2 * e + side
    out = np.full((count, 3, 3), np.inf)
    out[source] = 0.0
    done = np.zeros(count, np.bool_)
    heap = [(0.0, source)]
    while len(heap) > 0:
        _, node = heapq.heappop(heap)
        if done[node]:
            continue
        done[node] = True
        half = first[node]
        while half >= 0:
            e, other = half // 2, ends[half // 2, 1 - half % 2]
            if not done[other]:
                # the edge's error, in the axes of its second end, turned into the map's
                c, s = np.cos(poses[ends[e, 1], 2]), np.sin(poses[ends[e, 1], 2])
                R = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
                A = np.eye(3)
                A[0, 2] = -(poses[other, 1] - poses[node, 1])
                A[1, 2] = poses[other, 0] - poses[node, 0]
                found = A @ out[node] @ A.T + R @ local[e] @ R.T
                if found[0, 0] + found[1, 1] < out[other, 0, 0] + out[other, 1, 1]:
                    out[other] = found
                    heapq.heappush(heap, (found[0, 0] + found[1, 1], other))
            half = following[half]
    return out
