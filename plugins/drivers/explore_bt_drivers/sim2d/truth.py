"""The truth behind a simulated robot."""

from __future__ import annotations

from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from explore_bt.interfaces import GroundTruth
from explore_bt.types import OccupancyGrid, Pose2
from explore_bt_drivers.sim2d.arena import Arena
from explore_bt_drivers.sim2d.motion import STEP_S
from explore_bt_drivers.sim2d.simulation import Simulation
from explore_bt_drivers.world import SPARE_M

__all__ = ["Sim2dTruth"]


class Sim2dTruth(GroundTruth):
    """Reads the body, the crowd and the world; changes nothing."""

    def __init__(self, arena: Arena, start: Pose2, simulation: Simulation, range_m: float) -> None:
        self._arena = arena
        self._body = simulation.body
        self._crowd, self._touches = simulation.crowd, simulation.touches
        self._range_m = range_m
        self._start = start

    def pose(self) -> Pose2:
        """Where the robot is now, ``map`` frame."""
        return self._body.pose

    def start(self) -> Pose2:
        """Where the robot stood at first, whatever the mission says."""
        return self._start

    def contacts(self) -> int:
        """Separate touches; 5 mm must come between before there can be another.

        Of things, of other robots, and of people where the robot moved faster than 0.05 m/s at some moment
        of the touch.
        """
        return self._body.contacts + self._touches.met

    def clearance_m(self) -> float:
        """Exact distance from the robot's centre to the nearest solid of now, metres; not to who moves."""
        pose = self._body.pose
        return self._body.world.clearance_m(pose.x, pose.y)

    def people(self) -> NDArray[np.float64]:
        """Everybody in the world, at the time of ``pose``."""
        return self._crowd.at(self._body.track.last_step * STEP_S)

    def touched_by_people(self) -> int:
        """Touches during which the robot did not move, those that go on included."""
        return self._touches.at_rest

    def observable_floor(self) -> OccupancyGrid:
        """Cells of 0.05 m (or the map file's own) that can be seen from where it can get to, all as drawn."""
        return self._floor

    @cached_property
    def _floor(self) -> OccupancyGrid:
        return self._arena.observable_floor(self._start.xy, self._body.radius_m + SPARE_M, self._range_m)
