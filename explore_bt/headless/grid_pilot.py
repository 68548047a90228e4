"""The wheels of a robot that somebody else drives: it only watches how far along a path it has come."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from explore_bt.interfaces import ControlOutput, ControlStatus, HeldBy
from explore_bt.types import BodyFault, Path, Pose2, Twist2, wrap_angle

__all__ = ["GridPilot"]

_ARRIVED_M = 0.15
_ARRIVED_RAD = math.radians(10.0)
_STILL_M = 0.02
_STILL_RAD = math.radians(2.0)
_PATIENCE = 4


class GridPilot:
    """Implements ``Pilot`` by the poses that the caller reports.

    A path has arrived within 0.15 m of its end (a turn in place, within 10°); it is stuck when four reports
    in a row have brought no motion, which is taken for a place too tight.
    """

    blocked_s = 0.0
    gate_reason = ""
    held_by = HeldBy.OBSTACLE
    body_fault: BodyFault | None = None

    def recover_body(self) -> bool:
        """The caller sees to that."""
        return False

    in_the_way = ""

    def __init__(self) -> None:
        self.path: Path | None = None
        self._pose: Pose2 | None = None
        self._still = 0

    def follow(self, path: Path) -> None:
        """Offer a path to the caller."""
        self.path = path
        self._still = 0

    def hold(self) -> None:
        """Offer nothing."""
        self.path = None

    def report(self, pose: Pose2) -> None:
        """Where the robot is now."""
        before, self._pose = self._pose, pose
        moved = before is None or (
            pose.distance_to(before) > _STILL_M or abs(wrap_angle(pose.yaw_rad - before.yaw_rad)) > _STILL_RAD
        )
        self._still = 0 if moved else self._still + 1

    def passed(self, before: Pose2, now: Pose2) -> NDArray[np.float64]:
        """(N, 3) poses of the path between two places beside it."""
        if self.path is None or len(self.path.poses) == 1:
            return np.empty((0, 3))
        first, last = (_next_pose(self.path.poses[:, :2], np.array(pose.xy)) for pose in (before, now))
        return self.path.poses[first:last]

    @property
    def path_ahead(self) -> Path | None:
        """From where the robot is along what is left of the path; None while holding."""
        if self.path is None or self._pose is None or len(self.path.poses) == 1:
            return self.path
        after = _next_pose(self.path.poses[:, :2], np.array(self._pose.xy))
        here = [self._pose.x, self._pose.y, self._pose.yaw_rad]
        return Path(
            np.vstack((here, self.path.poses[after:])),
            np.append(self.path.clearance_m[after - 1], self.path.clearance_m[after:]),
        )

    @property
    def output(self) -> ControlOutput:
        """How the present path is going."""
        if self.path is None or self._pose is None:
            return ControlOutput(Twist2(), ControlStatus.IDLE)
        if self._has_arrived(self.path, self._pose):
            return ControlOutput(Twist2(), ControlStatus.ARRIVED)
        if self._still >= _PATIENCE:
            return ControlOutput(Twist2(), ControlStatus.STUCK, f"no motion in {_PATIENCE} reports")
        return ControlOutput(Twist2(), ControlStatus.RUNNING)

    @staticmethod
    def _has_arrived(path: Path, pose: Pose2) -> bool:
        if len(path.poses) == 1:
            return abs(wrap_angle(pose.yaw_rad - path.goal.yaw_rad)) <= _ARRIVED_RAD
        return pose.distance_to(path.goal) <= _ARRIVED_M


def _next_pose(points: NDArray[np.float64], here: NDArray[np.float64]) -> int:
    """Index of the end of the piece of a polyline (two points or more) that is nearest to a place."""
    along = np.diff(points, axis=0)
    square = np.maximum(np.einsum("ij,ij->i", along, along), 1e-12)
    share = np.clip(np.einsum("ij,ij->i", here - points[:-1], along) / square, 0.0, 1.0)
    off = points[:-1] + share[:, None] * along - here
    nearest = int(np.argmin(np.einsum("ij,ij->i", off, off)))
    return min(nearest + 1 + int(share[nearest] > 0.99), len(points) - 1)
