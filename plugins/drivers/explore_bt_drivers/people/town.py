"""Who walks about in a world: the people of its file, and walkers at random."""

from __future__ import annotations

import numpy as np

from explore_bt_drivers.people.crowd import Crowd
from explore_bt_drivers.people.strolls import Strolls
from explore_bt_drivers.people.walks import there_and_back
from explore_bt_drivers.world import World

__all__ = ["Town"]


class Town:
    """Knows the floor that walkers walk on; gives crowds that all do the same for the same generator."""

    def __init__(
        self,
        world: World,
        beside: tuple[float, float],
        walkers: int = 0,
        *,
        walker_radius_m: float = 0.25,
        walker_speed_mps: float = 1.2,
    ) -> None:
        """Find the floor for walkers, if there are to be any.

        Args:
            world: with the people of its file.
            beside: a place on the floor that walkers share with the robot; they begin away from it.
            walkers: how many walk about at random.
            walker_radius_m: of each.
            walker_speed_mps: of each.

        Raises:
            WorldError: there is no floor wide enough for them.
        """
        self._people = world.people
        self._walkers = walkers
        self._strolls = Strolls(world, beside, walker_radius_m, walker_speed_mps) if walkers else None

    def crowd(self, rng: np.random.Generator) -> Crowd:
        """Everybody where they begin; every walker draws from a generator of their own."""
        walks = [there_and_back(person) for person in self._people]
        if self._strolls is not None:
            walks += [self._strolls.walk(own) for own in rng.spawn(self._walkers)]
        return Crowd(walks)
