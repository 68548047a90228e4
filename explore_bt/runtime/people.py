"""What one scan tells about the robot's surroundings: returns, people, and where people may be unseen."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from explore_bt.interfaces import Surroundings
from explore_bt.runtime.hidden import HiddenFloor
from explore_bt.runtime.moving_things import MovingThings
from explore_bt.runtime.sight import Sight
from explore_bt.types import OccupancyGrid, Pose2, Scan2D, Twist2

__all__ = ["People"]

_NOWHERE = np.empty((0, 2))


class People:
    """Watches out for people; where they may hide matters only while some are about."""

    def __init__(self) -> None:
        self._things, self._floor = MovingThings(), HiddenFloor()

    def forget(self) -> None:
        """The scans seen so far no longer lie where the pose says: a loop closure moved it."""
        self._things.forget()
        self._floor = HiddenFloor()

    def around(
        self, scan: Scan2D, pose: Pose2, twist: Twist2, points: NDArray[np.float64], grid: OccupancyGrid
    ) -> Surroundings:
        """Take in a scan.

        Args:
            scan: the newest.
            pose: of the robot at its stamp, ``map`` frame.
            twist: of the robot during it.
            points: (N, 2) float64, metres, ``map`` frame: its returns.
            grid: the map.
        """
        sight = Sight.of(scan, pose, twist)
        if sight is None:
            return Surroundings(scan.stamp_s, points, grid)
        moving = self._things.see(sight, grid)
        hidden = self._floor.see(grid, sight, moving) if self._things.are_about(scan.stamp_s) else _NOWHERE
        return Surroundings(scan.stamp_s, points, grid, moving, hidden)
