"""The one world of all robots of a mission, and its time."""

from __future__ import annotations

import math
from collections.abc import Hashable
from typing import Protocol

from explore_bt.clock import ManualClock
from explore_bt.types import OccupancyGrid
from explore_bt_drivers.sim2d.body import Body
from explore_bt_drivers.sim2d.bumps import Bumps
from explore_bt_drivers.sim2d.motion import ON_STEP, STEP_S
from explore_bt_drivers.world import Scenery, World, observable_floor
from explore_bt_drivers.world.observable import reachable_cells

__all__ = ["Arena", "Dweller"]

_CHUNK_STEPS = 100


class Dweller(Protocol):
    """A robot as its world knows it."""

    @property
    def body(self) -> Body:
        """What moves, and is run into."""

    def enter(self, world: World) -> None:
        """The version of the world that is in force from now on."""

    def advance(self, last_step: int) -> None:
        """Move on to an internal step, people too."""

    def measure(self) -> None:
        """Take what the sensors have to tell by now; everybody has moved on."""


class Arena(ManualClock):
    """World and time: waiting moves all robots on together, then all of them measure.

    They move in steps of ``STEP_S`` counted from 0, so that the same commands at the same times give the same
    states however the waiting is cut up. What changes in the world does so on a step, after all that was due
    by then has been measured; a sweep sees the version in which it ends.

    Attributes:
        bodies: of the robots, in the order they came.
    """

    def __init__(self, world: World, begin_s: float = 0.0) -> None:
        super().__init__(begin_s)
        self.world = world
        self.bodies: list[Body] = []
        self._dwellers: list[Dweller] = []
        self._step = math.floor(begin_s / STEP_S + ON_STEP)
        self._scenery = Scenery(world, STEP_S)
        self._bumps = Bumps(self.bodies)
        self._floors: dict[Hashable, OccupancyGrid] = {}

    @property
    def step(self) -> int:
        """The internal step that everybody has come to."""
        return self._step

    def admit(self, dweller: Dweller) -> None:
        """Another robot stands in the world from now on."""
        self._dwellers.append(dweller)
        self.bodies.append(dweller.body)

    def wait_until(self, time_s: float) -> None:
        """Advance the world to ``time_s``."""
        super().wait_until(time_s)
        last_step = math.floor(self.now_s() / STEP_S + ON_STEP)
        while self._step < last_step:
            self._advance(last_step)
            for dweller in self._dwellers:
                dweller.measure()

    def observable_floor(
        self, start_xy: tuple[float, float], radius_m: float, range_m: float
    ) -> OccupancyGrid:
        """See there; computed once for all robots of one size that can come to one another."""
        reachable = reachable_cells(self.world, start_xy, radius_m)
        key = (radius_m, range_m, reachable.tobytes())
        if key not in self._floors:
            self._floors[key] = observable_floor(self.world, start_xy, radius_m, range_m)
        return self._floors[key]

    def _advance(self, last_step: int) -> None:
        """Move on towards an internal step, at most to where the world may change or robots may meet."""
        step = self._step
        world = self._scenery.settle(
            step, [(body.pose.x, body.pose.y, body.radius_m) for body in self.bodies]
        )
        for dweller in self._dwellers:
            dweller.enter(world)
        until = min(
            last_step, step + _CHUNK_STEPS, step + self._bumps.apart_steps(), self._scenery.next_step(step)
        )
        for dweller in self._dwellers:
            dweller.advance(until)
        self._bumps.settle()
        self._step = until
