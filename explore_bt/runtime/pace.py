"""Simulated time held to real time, for robots in processes of their own."""

from __future__ import annotations

from typing import TYPE_CHECKING

from explore_bt.clock import WallClock
from explore_bt.mission import Mission
from explore_bt.runtime.attendant import Attendant

if TYPE_CHECKING:
    from explore_bt.runtime.runner import Runner

__all__ = ["Pace", "pace_of"]


class Pace(Attendant):
    """Waits before a tick until as much real time has gone by as simulated; one that is late catches up.

    Args:
        rate: simulated seconds a second.
    """

    def __init__(self, rate: float = 1.0) -> None:
        self._rate = rate
        self._clock = WallClock()
        self._runner: Runner | None = None
        self._begin_s = 0.0

    def begin(self, runner: Runner) -> None:
        """From now on."""
        self._runner, self._begin_s = runner, runner.now_s
        self._clock = WallClock()

    def on_hold(self) -> None:
        """Also while it is paused: its team is told so all the time."""
        self.on_period()

    def on_period(self) -> None:
        """Let the others come up."""
        if self._runner is not None and self._runner.is_simulated:
            self._clock.wait_until((self._runner.now_s - self._begin_s) / self._rate)


def pace_of(mission: Mission) -> Attendant:
    """Who holds a robot in a process of its own to real time; robots of one process need nobody."""
    return Attendant() if mission.solo is None else Pace(mission.solo.pace)
