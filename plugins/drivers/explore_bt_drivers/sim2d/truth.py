"""The truth behind a simulated robot."""

from __future__ import annotations

from functools import cached_property

from explore_bt.interfaces import GroundTruth
from explore_bt.types import OccupancyGrid, Pose2
from explore_bt_drivers.sim2d.body import Body
from explore_bt_drivers.world import World, observable_floor

__all__ = ["SPARE_M", "Sim2dTruth"]

SPARE_M = 0.025
"""A way counts only if it leaves this much on either side: through an exact fit no lidar guides a robot."""


class Sim2dTruth(GroundTruth):
    """Reads the body and the world; changes nothing."""

    def __init__(self, world: World, body: Body, radius_m: float, range_m: float) -> None:
        self._world = world
        self._body = body
        self._radius_m = radius_m
        self._range_m = range_m
        self._start = body.pose

    def pose(self) -> Pose2:
        """Where the robot is now, ``map`` frame."""
        return self._body.pose

    def contacts(self) -> int:
        """Separate touches; the footprint must move 5 mm away before it can touch again."""
        return self._body.contacts

    def clearance_m(self) -> float:
        """Exact distance from the robot's centre to the nearest solid, metres."""
        pose = self._body.pose
        return self._world.clearance_m(pose.x, pose.y)

    def observable_floor(self) -> OccupancyGrid:
        """Cells of 0.05 m (or the map file's own) that can be seen from where the robot can get to."""
        return self._floor

    @cached_property
    def _floor(self) -> OccupancyGrid:
        return observable_floor(self._world, self._start.xy, self._radius_m + SPARE_M, self._range_m)
