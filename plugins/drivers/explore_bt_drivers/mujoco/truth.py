"""The truth behind the physical robot."""

from __future__ import annotations

from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from explore_bt.interfaces import GroundTruth
from explore_bt.types import OccupancyGrid, Pose2
from explore_bt_drivers.mujoco.figures import BODY_HEIGHT_M
from explore_bt_drivers.mujoco.simulation import Simulation
from explore_bt_drivers.world import SPARE_M, World, observable_floor
from explore_bt_drivers.world.index import clearance_of
from explore_bt_drivers.world.solid import outline_edges

__all__ = ["MujocoTruth"]


class MujocoTruth(GroundTruth):
    """Reads body, contacts, people and world; changes nothing."""

    def __init__(
        self, world: World, start: Pose2, simulation: Simulation, radius_m: float, range_m: float
    ) -> None:
        self._drawn = world
        self._simulation = simulation
        self._start = start
        self._radius_m, self._range_m = radius_m, range_m

    def pose(self) -> Pose2:
        """Where ``base_link`` is now, seen from above, ``map`` frame."""
        return self._simulation.body.pose

    def contacts(self) -> int:
        """Separate touches of the body, at any height, with anything but what its wheels roll on.

        5 mm must come between before there can be another. Of people only those count during which the robot
        was on its way faster than 0.05 m/s.
        """
        return self._simulation.contacts.of_things + self._simulation.contacts.met

    def clearance_m(self) -> float:
        """Exact distance from ``base_link`` to the nearest solid that it could run into; no people."""
        x, y = self.pose().xy
        surroundings = self._simulation.surroundings
        in_the_way = surroundings.overhangs(BODY_HEIGHT_M)
        above = [clearance_of(outline_edges(solid.corners), x, y) for solid in in_the_way]
        return float(min([surroundings.world.clearance_m(x, y), *above]))

    def people(self) -> NDArray[np.float64]:
        """Everybody in the world, at the time of ``pose``."""
        return self._simulation.surroundings.scene.crowd.at(self._simulation.body.track.now_s)

    def touched_by_people(self) -> int:
        """Touches during which the robot did not move by itself, those that go on included."""
        return self._simulation.contacts.at_rest

    def observable_floor(self) -> OccupancyGrid:
        """Cells of 0.05 m (or the map file's own) that can be seen from where it can get to, all as drawn."""
        return self._floor

    @cached_property
    def _floor(self) -> OccupancyGrid:
        return observable_floor(self._drawn, self._start.xy, self._radius_m + SPARE_M, self._range_m)
