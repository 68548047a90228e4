"""Planar poses and twists: REP-105 frames, REP-103 units."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

__all__ = ["Pose2", "Twist2", "wrap_angle"]


def wrap_angle(angle_rad: float) -> float:
    """The same angle in [-π, π)."""
    return (angle_rad + math.pi) % (2.0 * math.pi) - math.pi


@dataclass(frozen=True, slots=True)
class Pose2:
    """A pose in SE(2): metres, radians counter-clockwise from x.

    As a transform it takes points of its own frame into its parent's:
    ``T_map_base = Pose2(...)``, ``p_map = T_map_base.apply(p_base)``.
    """

    x: float
    y: float
    yaw_rad: float

    @staticmethod
    def identity() -> Pose2:
        """The origin, facing along x."""
        return Pose2(0.0, 0.0, 0.0)

    @property
    def xy(self) -> tuple[float, float]:
        """The position, metres."""
        return (self.x, self.y)

    def compose(self, other: Pose2) -> Pose2:
        """``T_a_b.compose(T_b_c) = T_a_c``."""
        cos, sin = math.cos(self.yaw_rad), math.sin(self.yaw_rad)
        return Pose2(
            self.x + cos * other.x - sin * other.y,
            self.y + sin * other.x + cos * other.y,
            wrap_angle(self.yaw_rad + other.yaw_rad),
        )

    def inverse(self) -> Pose2:
        """``T_a_b.inverse() = T_b_a``."""
        cos, sin = math.cos(self.yaw_rad), math.sin(self.yaw_rad)
        return Pose2(
            -cos * self.x - sin * self.y,
            sin * self.x - cos * self.y,
            wrap_angle(-self.yaw_rad),
        )

    def between(self, other: Pose2) -> Pose2:
        """``other`` as seen from this pose: ``T_a_b.between(T_a_c) = T_b_c``."""
        return self.inverse().compose(other)

    def apply(self, points: NDArray[np.floating]) -> NDArray[np.float64]:
        """Points of this pose's frame in the parent frame.

        Args:
            points: (N, 2) float, metres, in the frame of this pose.

        Returns:
            (N, 2) float64, metres, in the parent frame.
        """
        cos, sin = math.cos(self.yaw_rad), math.sin(self.yaw_rad)
        rotation = np.array([[cos, -sin], [sin, cos]])
        return np.asarray(points, dtype=np.float64) @ rotation.T + np.array([self.x, self.y])

    def distance_to(self, other: Pose2) -> float:
        """Metres between the two positions; headings do not count."""
        return math.hypot(other.x - self.x, other.y - self.y)

    def as_array(self) -> NDArray[np.float64]:
        """(3,) float64: x, y in metres, yaw in radians."""
        return np.array([self.x, self.y, self.yaw_rad])


@dataclass(frozen=True, slots=True)
class Twist2:
    """The velocity of a unicycle: along its own x, and about z."""

    linear_mps: float = 0.0
    angular_rps: float = 0.0

    @property
    def is_zero(self) -> bool:
        """Whether the robot stands still under this twist."""
        return self.linear_mps == 0.0 and self.angular_rps == 0.0
