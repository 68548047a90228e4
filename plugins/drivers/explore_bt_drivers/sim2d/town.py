"""Who walks about in a world: the people of its file, and walkers at random."""

from __future__ import annotations

import numpy as np

from explore_bt.types import Pose2
from explore_bt_drivers.sim2d.crowd import Crowd
from explore_bt_drivers.sim2d.options import Sim2dOptions
from explore_bt_drivers.sim2d.strolls import Strolls
from explore_bt_drivers.sim2d.walks import there_and_back
from explore_bt_drivers.world import World

__all__ = ["Town"]


class Town:
    """Knows the floor that walkers walk on; gives crowds that all do the same for the same generator."""

    def __init__(self, world: World, options: Sim2dOptions, start: Pose2) -> None:
        """Find the floor for walkers, if there are to be any.

        Raises:
            WorldError: there is none wide enough for them.
        """
        self._people = world.people
        self._walkers = options.walkers
        self._strolls = (
            Strolls(world, start.xy, options.walker_radius, options.walker_speed) if options.walkers else None
        )

    def crowd(self, rng: np.random.Generator, footprint_m: float) -> Crowd:
        """Everybody where they begin, as a robot of that radius meets them.

        Every walker draws from a generator of their own.
        """
        walks = [there_and_back(person) for person in self._people]
        if self._strolls is not None:
            walks += [self._strolls.walk(own) for own in rng.spawn(self._walkers)]
        return Crowd(walks, footprint_m)
