"""How the robot moved during a sweep."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from explore_bt.types import Pose2, wrap_angle

__all__ = ["Trail"]


@dataclass(frozen=True, slots=True, eq=False)
class Trail:
    """Poses of ``base_link`` over time, in the frame of the first one.

    Attributes:
        times_s: (N,) float64, rising, N >= 1.
        poses: (N, 3) float64: x, y in metres, yaw in radians, not wrapped.
    """

    times_s: NDArray[np.float64]
    poses: NDArray[np.float64]

    @property
    def span_s(self) -> float:
        """From the first pose to the last, seconds."""
        return float(self.times_s[-1] - self.times_s[0])

    @property
    def motion(self) -> Pose2:
        """From the first pose to the last."""
        x, y, yaw = self.poses[-1]
        return Pose2(float(x), float(y), wrap_angle(float(yaw)))

    def corrected_to(self, motion: Pose2) -> Trail:
        """The same trail, bent evenly over time so that it ends where registration says."""
        if self.span_s <= 0.0:
            return self
        predicted = self.motion
        missing = np.array(
            [motion.x - predicted.x, motion.y - predicted.y, wrap_angle(motion.yaw_rad - predicted.yaw_rad)]
        )
        share = ((self.times_s - self.times_s[0]) / self.span_s)[:, None]
        return Trail(self.times_s, self.poses + share * missing)

    @staticmethod
    def standing(stamp_s: float) -> Trail:
        """No motion at all."""
        return Trail(np.array([stamp_s]), np.zeros((1, 3)))

    def since(self, start_s: float) -> Trail:
        """The part from ``start_s`` on (with the sample before it), in the same frame."""
        first = max(int(np.searchsorted(self.times_s, start_s, side="right")) - 1, 0)
        return Trail(self.times_s[first:], self.poses[first:])
