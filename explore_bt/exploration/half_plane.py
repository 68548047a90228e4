"""Forward half-planes, and their intersection since the last reset."""

from __future__ import annotations

import math
from dataclasses import dataclass

from explore_bt.exploration.arguments import require_at_least
from explore_bt.types import Pose2

__all__ = ["HalfPlane", "HalfPlaneHistory"]

_ON_THE_LINE_M = 1e-9  # a waypoint abreast of the robot lies on the line, whichever way it was rounded


@dataclass(frozen=True, slots=True)
class HalfPlane:
    """H^k: what lies ahead of, or abreast of, a robot at a waypoint, in the ``map`` frame.

    The paper writes the line with tan(90° + r), which flips side with the heading; its text ("points
    forward") is the scalar product that stands here.

    Attributes:
        position: p^k, metres.
        heading_rad: r^{k,z}, radians.
    """

    position: tuple[float, float]
    heading_rad: float

    @staticmethod
    def ahead_of(pose: Pose2) -> HalfPlane:
        """The half-plane in front of a robot at this pose."""
        return HalfPlane(pose.xy, pose.yaw_rad)

    def ahead_m(self, xy: tuple[float, float]) -> float:
        """(p − p^k) · (cos r, sin r) for a point in metres: how far ahead of the line it lies."""
        dx, dy = xy[0] - self.position[0], xy[1] - self.position[1]
        return dx * math.cos(self.heading_rad) + dy * math.sin(self.heading_rad)

    def contains(self, xy: tuple[float, float]) -> bool:
        """Whether a point in metres lies ahead of the line, or on it."""
        return self.ahead_m(xy) >= -_ON_THE_LINE_M


@dataclass(frozen=True, slots=True)
class HalfPlaneHistory:
    """The half-planes since the last reset, oldest first; an empty history constrains nothing."""

    planes: tuple[HalfPlane, ...] = ()

    def push(self, plane: HalfPlane) -> HalfPlaneHistory:
        """The history with one more half-plane, the newest."""
        return HalfPlaneHistory((*self.planes, plane))

    def reset(self) -> HalfPlaneHistory:
        """The empty history: the pseudo-code's H ← ∅, read as "no constraint"."""
        return HalfPlaneHistory()

    def last(self, window: int | None = None) -> tuple[HalfPlane, ...]:
        """The newest L = ``window`` half-planes; None is the paper's L = k, all of them.

        Raises:
            ArgumentError: if the window is below 1.
        """
        if window is None:
            return self.planes
        require_at_least(1, half_planes=window)
        return self.planes[-window:]

    def contains(self, xy: tuple[float, float], window: int | None = None) -> bool:
        """Whether a point in metres lies in H_{k−L+1}^k, the intersection of the newest L half-planes."""
        return self.broken_by(xy, window) is None

    def broken_by(self, xy: tuple[float, float], window: int | None = None) -> HalfPlane | None:
        """The newest of them that a point in metres does not lie in; None if it lies in all."""
        return next((plane for plane in reversed(self.last(window)) if not plane.contains(xy)), None)
