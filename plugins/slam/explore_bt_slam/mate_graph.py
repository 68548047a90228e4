"""The pose graph of another robot, as far as it has been told."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from explore_bt.types import STRETCH_KEYFRAMES, Pose2, SharedEdge, SharedKeyframe, SharedStretch
from explore_bt_slam.keyframes import Keyframe
from explore_bt_slam.surfels import normals_of

__all__ = ["MateGraph"]


class MateGraph:
    """Keyframes from the first one on without a gap; what comes before its turn waits.

    Attributes:
        keyframes: those of which scan and pose are known.
        revision: grows with whatever is told.
    """

    def __init__(self) -> None:
        self.keyframes: list[Keyframe] = []
        self.revision = 0
        self._scans: dict[int, SharedKeyframe] = {}
        self._stretches: dict[int, SharedStretch] = {}
        self._poses = np.zeros((0, 3))

    @property
    def poses(self) -> NDArray[np.float64]:
        """(N, 3) float64 of ``keyframes``, in the other robot's ``map`` frame, as it solves its own graph."""
        return self._poses

    def pose(self, number: int) -> Pose2:
        """Of one keyframe, likewise."""
        return Pose2(*self._poses[number].tolist())

    def edges(self) -> list[SharedEdge]:
        """The constraints between ``keyframes``."""
        count = len(self.keyframes)
        return [
            edge
            for number in sorted(self._stretches)
            for edge in self._stretches[number].edges
            if edge.b < count and edge.a < count
        ]

    def take(self, told: SharedKeyframe | SharedStretch) -> None:
        """The newest of each counts."""
        self.revision += 1
        if isinstance(told, SharedStretch):
            self._stretches[told.number] = told
        elif told.number >= len(self.keyframes):
            self._scans[told.number] = told
        while self._has_next():
            scan = self._scans.pop(len(self.keyframes))
            self.keyframes.append(Keyframe(scan.stamp_s, scan.points, normals_of(scan.points), scan.driven_m))
        parts = [self._stretches[number].poses for number in range(self._whole_stretches())]
        if parts:
            self._poses = np.concatenate(parts)[: len(self.keyframes)]

    def _has_next(self) -> bool:
        """Whether the next keyframe has been seen, placed and reached by a step."""
        number = len(self.keyframes)
        stretch = self._stretches.get(number // STRETCH_KEYFRAMES)
        if number not in self._scans or stretch is None:
            return False
        is_placed = len(stretch.poses) > number % STRETCH_KEYFRAMES
        is_reached = any(edge.b == number and not edge.is_closure for edge in stretch.edges)
        return is_placed and (is_reached or number == 0)

    def _whole_stretches(self) -> int:
        numbers = sorted(self._stretches)
        gaps = [one + 1 for one, other in pairwise([-1, *numbers]) if other != one + 1]
        return min(gaps, default=len(numbers))
