"""Which version of a world is in force."""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Sequence

from explore_bt_drivers.world.index import clearance_of
from explore_bt_drivers.world.plan import Stand
from explore_bt_drivers.world.solid import outline_edges
from explore_bt_drivers.world.versions import with_solids
from explore_bt_drivers.world.world import World

__all__ = ["Scenery"]

_SPARE_M = 0.01
_NEVER = 2**62
_ON_STEP = 1e-6
"""A time this near to a step's (in steps) is that step's."""


class Scenery:
    """Moves the things of a world when they are due and no robot is in the way.

    A thing goes to where it should be by now, or stays where it is until every footprint and 1 cm around it
    are clear of that place.

    Attributes:
        world: the version in force.
        stands: the number of the stand of each of its things.
    """

    def __init__(self, world: World, step_s: float) -> None:
        """Begin as drawn.

        Args:
            world: as drawn.
            step_s: length of an internal step; step k belongs to time ``k * step_s``.
        """
        self.world = world
        self._drawn = world
        self._dues = [[_step_of(stand, step_s) for stand in thing.stands] for thing in world.things]
        self.stands = (0,) * len(world.things)
        self._versions = {self.stands: world}
        self._steps = sorted(step for dues in self._dues for step in dues)

    def settle(self, step: int, footprints: Sequence[tuple[float, float, float]]) -> World:
        """Bring the world up to an internal step; the version in force.

        Args:
            step: the internal step.
            footprints: x, y and radius of every robot, metres.
        """
        stands = self._wanted(step)
        if stands != self.stands:
            self._settle(stands, footprints)
        return self.world

    def next_step(self, step: int) -> int:
        """The internal step after ``step`` at which to settle again: a thing is due, or waits."""
        if self._wanted(step) != self.stands:
            return step + 1
        place = bisect_right(self._steps, step)
        return self._steps[place] if place < len(self._steps) else _NEVER

    def _wanted(self, step: int) -> tuple[int, ...]:
        """Where every thing should be at an internal step."""
        return tuple([bisect_right(dues, step) - 1 for dues in self._dues])

    def _settle(self, wanted: tuple[int, ...], footprints: Sequence[tuple[float, float, float]]) -> None:
        things = enumerate(zip(self.stands, wanted, strict=True))
        self.stands = tuple(
            [
                to if to != now and self._is_clear(thing, to, footprints) else now
                for thing, (now, to) in things
            ]
        )
        self.world = self._version()

    def _is_clear(self, thing: int, stand: int, footprints: Sequence[tuple[float, float, float]]) -> bool:
        edges = [outline_edges(solid.corners) for solid in self._drawn.things[thing].stands[stand].solids]
        gaps = (clearance_of(each, x, y) - radius_m for each in edges for x, y, radius_m in footprints)
        return bool(min(gaps, default=math.inf) >= _SPARE_M)

    def _version(self) -> World:
        """The world with its things as they stand; each version is built once."""
        if self.stands not in self._versions:
            pairs = zip(self._drawn.things, self.stands, strict=True)
            solids = [solid for thing, now in pairs for solid in thing.stands[now].solids]
            self._versions[self.stands] = with_solids(self._drawn, solids)
        return self._versions[self.stands]


def _step_of(stand: Stand, step_s: float) -> int:
    return math.ceil(stand.begin_s / step_s - _ON_STEP)
