"""The world that all simulated robots of a mission share, from set-up on."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from explore_bt.errors import WorldError
from explore_bt.interfaces import RobotContext
from explore_bt.types import Pose2
from explore_bt_drivers.people import Crowd, Town
from explore_bt_drivers.sim2d.arena import Arena
from explore_bt_drivers.sim2d.options import Sim2dOptions
from explore_bt_drivers.world import Taken, World, choose_start, load_world

__all__ = ["Venue"]

_PEOPLE = ("walkers", "walker_speed", "walker_radius")


@dataclass(frozen=True, slots=True)
class _People:
    """Who walks about: as the first robot's options and generator say."""

    town: Town
    options: Sim2dOptions
    context: RobotContext


class Venue:
    """One file's world: its arena, its people, and where robots begin; made by the first that comes."""

    def __init__(self, options: Sim2dOptions, begin_s: float) -> None:
        """Read the world.

        Raises:
            WorldError: it cannot be used.
        """
        self.world: World = load_world(options.world)
        self.arena = Arena(self.world, begin_s)
        self._starts: dict[str, Taken] = {}
        self._people: _People | None = None

    @staticmethod
    def of(options: Sim2dOptions, context: RobotContext) -> Venue:
        """The one of this mission and world."""
        begin_s = context.resumed.stamp_s if context.resumed else 0.0
        return context.commons.get(("sim2d", options.world.resolve()), lambda: Venue(options, begin_s))

    def start(self, options: Sim2dOptions, context: RobotContext) -> Pose2:
        """Where a robot really begins, clear of those that came before it.

        Raises:
            WorldError: there is no room for it.
        """
        wanted = context.start if options.stand is None else Pose2(*options.stand)
        start = choose_start(self.world, wanted, options.radius, self._starts)
        self._starts[context.robot] = Taken(start.xy, options.radius)
        return start

    def crowd(self, options: Sim2dOptions, context: RobotContext, start: Pose2) -> Crowd:
        """Everybody who walks there, as one robot meets them; they are the same for all robots.

        Raises:
            WorldError: no floor for walkers, or other ones than the robots before asked for.
        """
        if self._people is None:
            self._people = _People(_town(self.world, options, start), options, context)
        people = self._people
        for name in _PEOPLE:
            asked, there = getattr(options, name), getattr(people.options, name)
            if asked != there:
                raise WorldError(
                    f"{self.world.source}: robot {context.robot} asks for {name} = {asked:g}, robot "
                    f"{people.context.robot} in the same world for {there:g}; give both the same"
                )
        return people.town.crowd(self._rng())

    def _rng(self) -> np.random.Generator:
        assert self._people is not None
        return self._people.context.rng("walkers")


def _town(world: World, options: Sim2dOptions, start: Pose2) -> Town:
    return Town(
        world,
        start.xy,
        options.walkers,
        walker_radius_m=options.walker_radius,
        walker_speed_mps=options.walker_speed,
    )
