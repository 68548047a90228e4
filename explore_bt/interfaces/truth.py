"""What only a simulator knows."""

from __future__ import annotations

from abc import ABC, abstractmethod

from explore_bt.types import OccupancyGrid, Pose2

__all__ = ["GroundTruth"]


class GroundTruth(ABC):
    """The truth behind a simulated robot, in the ``map`` frame; read by scores and tests only."""

    @abstractmethod
    def pose(self) -> Pose2:
        """Where the robot is now."""

    @abstractmethod
    def contacts(self) -> int:
        """How many separate times the footprint has touched something."""

    @abstractmethod
    def clearance_m(self) -> float:
        """Exact distance from the robot's centre to the nearest obstacle, metres."""

    @abstractmethod
    def observable_floor(self) -> OccupancyGrid:
        """The floor that can be seen from where the robot can get to.

        Reachable: joined to the start by a way for the footprint with 2.5 cm to spare on either side.
        Observable: within the lidar's range
        and line of sight of a reachable place. Those cells are ``FREE``, all others ``UNKNOWN``.
        Computed once, on first use.
        """
