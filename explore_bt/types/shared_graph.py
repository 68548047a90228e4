"""Pose graphs that robots tell one another, and how two of their maps lie to each other."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from explore_bt.types.pose import Pose2

__all__ = ["STRETCH_KEYFRAMES", "MapFit", "SharedEdge", "SharedKeyframe", "SharedStretch"]

STRETCH_KEYFRAMES = 16
"""Keyframes are told of in stretches of so many, numbered from the first."""


@dataclass(frozen=True, slots=True, eq=False)
class SharedKeyframe:
    """What was seen from a keyframe; never changes.

    Attributes:
        number: counts a robot's keyframes from 0.
        driven_m: way from the robot's first keyframe to here.
        points: (N, 2) float64, metres, base frame, in beam order.
    """

    number: int
    stamp_s: float
    driven_m: float
    points: NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class SharedEdge:
    """A measured relative pose between two keyframes of one robot.

    Attributes:
        a, b: their numbers; ``relative`` is ``T_a_b``.
        covariance: (3, 3) float64 over x, y (m²), yaw (rad²), in the axes of ``b``.
        is_closure: found by place, not by driving.
    """

    a: int
    b: int
    relative: Pose2
    covariance: NDArray[np.float64]
    is_closure: bool


@dataclass(frozen=True, slots=True, eq=False)
class SharedStretch:
    """Where a robot now has some of its keyframes, and what was measured that led there.

    Attributes:
        number: the first keyframe is ``STRETCH_KEYFRAMES`` times this.
        poses: (N, 3) float64: x, y (m), yaw (rad) in that robot's ``map`` frame; N at most
            ``STRETCH_KEYFRAMES``.
        edges: the constraints whose later end is one of these keyframes.
    """

    number: int
    poses: NDArray[np.float64]
    edges: tuple[SharedEdge, ...]


@dataclass(frozen=True, slots=True, eq=False)
class MapFit:
    """How another robot's map lies in one's own: about each of its keyframes as in one graph of both.

    Attributes:
        theirs: (K, 3) float64: keyframes (x, y, yaw) in the other's ``map`` frame, K at least 1.
        ours: (K, 3) float64: the same keyframes in one's own.
    """

    theirs: NDArray[np.float64]
    ours: NDArray[np.float64]

    @staticmethod
    def rigid(T_ours_theirs: Pose2) -> MapFit:
        """The same everywhere."""
        return MapFit(np.zeros((1, 3)), T_ours_theirs.as_array()[None, :])

    def at_theirs(self, x: float, y: float) -> Pose2:
        """``T_ours_theirs`` about a place of the other's map, metres."""
        return self._of(self.theirs, x, y)

    def at_ours(self, x: float, y: float) -> Pose2:
        """``T_ours_theirs`` about a place of one's own map, metres."""
        return self._of(self.ours, x, y)

    def _of(self, places: NDArray[np.float64], x: float, y: float) -> Pose2:
        nearest = int(np.argmin((places[:, 0] - x) ** 2 + (places[:, 1] - y) ** 2))
        here, there = Pose2(*self.ours[nearest].tolist()), Pose2(*self.theirs[nearest].tolist())
        return here.compose(there.inverse())
