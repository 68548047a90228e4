"""What only a simulator knows."""

from __future__ import annotations

from abc import ABC, abstractmethod

import numpy as np
from numpy.typing import NDArray

from explore_bt.types import OccupancyGrid, Pose2

__all__ = ["GroundTruth"]


class GroundTruth(ABC):
    """The truth behind a simulated robot, in the frame of its world; read by scores and tests only.

    That is the ``map`` frame, unless a mission says that the robot's start is unknown, or says it wrong.
    """

    @abstractmethod
    def pose(self) -> Pose2:
        """Where the robot is now."""

    def start(self) -> Pose2 | None:
        """Where the robot began, where that is not what its driver calls its start (None, the default)."""
        return None

    @abstractmethod
    def contacts(self) -> int:
        """How many separate times the footprint has touched something, or somebody while it moved."""

    @abstractmethod
    def clearance_m(self) -> float:
        """Exact distance from the robot's centre to the nearest obstacle, metres; people do not count."""

    @abstractmethod
    def observable_floor(self) -> OccupancyGrid:
        """The floor that can be seen from where the robot can get to.

        Reachable: joined to the start by a way for the footprint with 2.5 cm to spare on either side.
        Observable: within the lidar's range
        and line of sight of a reachable place. Those cells are ``FREE``, all others ``UNKNOWN``.
        Computed once, on first use.
        """

    def people(self) -> NDArray[np.float64]:
        """Everybody who is about now.

        Returns:
            (K, 5) float64: x, y, vx, vy, radius; metres and seconds. Nobody, unless overridden.
        """
        return np.empty((0, 5))

    def touched_by_people(self) -> int:
        """How many separate times somebody has touched the footprint while it stood."""
        return 0
