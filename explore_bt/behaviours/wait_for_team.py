"""Leaf: while the others still work there may be something to do again."""

from __future__ import annotations

import numpy as np

from explore_bt.tree import Input, Leaf, Status
from explore_bt.types import UNKNOWN, Doing
from explore_bt.units import Area, Duration

__all__ = ["WaitForTeam"]

_LAST_M2 = 0.1


class WaitForTeam(Leaf):
    """Waits until the map of all has grown, as one of those who have found nothing to do.

    SUCCESS once there is more to look through, or somebody who was at work is silent or paused: what it had
    claimed is left. FAILURE once nobody of the team is at work any more and the map is the one that was last
    looked through. A robot that is alone fails at once.
    """

    type_key = "wait_for_team"

    grown: Input[float] = Input(Area, default=1.0, ge=0.0, doc="look again once so much more is known")
    every: Input[float] = Input(Duration, default=2.0, ge=0.0, doc="but not more often than this")
    at_most: Input[float] = Input(
        Duration, default=10.0, ge=0.0, doc="look again after so long, for claims are given up too"
    )

    def initialise(self) -> None:
        """Remember what has been looked through."""
        self._since_s = self.robot.now_s()
        self._known_m2 = self._area_m2()
        self._workers = {mate.name for mate in self.robot.team.mates if mate.doing is Doing.AT_WORK}
        self.robot.team.claim(())
        self.robot.team.say_doing(Doing.IDLE)

    def update(self) -> Status:
        """Has the map grown, and is anybody at work?"""
        at_work = [mate.name for mate in self.robot.team.mates if mate.doing is Doing.AT_WORK]
        self._workers.update(at_work)
        going_on = {mate.name for mate in self.robot.team.mates if mate.doing is not Doing.PAUSED}
        if gone := self._workers - going_on:
            self.robot.team.say_doing(Doing.AT_WORK)
            self.say(f"{', '.join(sorted(gone))} is silent or paused: look again")
            return Status.SUCCESS
        new_m2 = self._area_m2() - self._known_m2
        waited_s = self.robot.now_s() - self._since_s
        if not at_work:
            if new_m2 < _LAST_M2:
                self.say("nobody of the team has anything left to do" if self.robot.team.mates else "")
                return Status.FAILURE
        elif waited_s < self.every or (new_m2 < self.grown and waited_s < self.at_most):
            self.say(f"at work: {', '.join(at_work)}")
            return Status.RUNNING
        self.robot.team.say_doing(Doing.AT_WORK)
        self.say(f"{new_m2:.1f} m² more are known: look again")
        return Status.SUCCESS

    def _area_m2(self) -> float:
        grid = self.robot.view().grid
        return float(np.count_nonzero(grid.cells != UNKNOWN)) * grid.resolution_m**2
