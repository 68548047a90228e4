"""A robot in real time: ``sim2d`` whose clock is the wall's, some times as fast so that tests are short."""

from __future__ import annotations

from collections.abc import Sequence

from explore_bt_drivers import Sim2d

from explore_bt.clock import Clock, WallClock
from explore_bt.interfaces import RobotContext
from explore_bt.types import Measurement

HASTE = 2.0
"""Seconds of mission time to one of the wall's."""


class _Hasty(Clock):
    """The wall's clock, ``HASTE`` times as fast, with a world that keeps up with it."""

    def __init__(self, world: Clock) -> None:
        self._wall, self._world = WallClock(), world

    @property
    def is_simulated(self) -> bool:
        return False

    def now_s(self) -> float:
        return self._wall.now_s() * HASTE

    def wait_until(self, time_s: float) -> None:
        self._wall.wait_until(time_s / HASTE)
        self._world.wait_until(self.now_s())


class WallSim2d(Sim2d):
    """Nobody can hold its time."""

    name = "wall_sim2d"

    def setup(self, context: RobotContext) -> None:
        super().setup(context)
        self._hasty: _Hasty | None = None

    @property
    def clock(self) -> Clock:
        if self._hasty is None:  # time begins when somebody asks for it
            self._hasty = _Hasty(super().clock)
        return self._hasty

    def read(self) -> Sequence[Measurement]:
        now_s = self.clock.now_s()
        return [each for each in super().read() if each.stamp_s <= now_s]
