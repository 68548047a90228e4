"""Which robot is looked at, and when."""

from __future__ import annotations

from explore_bt.debug.commands import View
from explore_bt.debug.history import History
from explore_bt.debug.terminal.parsing import Span
from explore_bt.errors import DebugError
from explore_bt.interfaces import NodeInfo, RobotSnapshot, TickSnapshot
from explore_bt.mission.words import did_you_mean

__all__ = ["Focus"]

_NEWEST = 10**12


class Focus:
    """A robot and a tick of a run that is kept in memory.

    Attributes:
        chosen: the robot that a person has chosen; empty for the one the run is paused at.
    """

    def __init__(self, history: History) -> None:
        self._history = history
        self._past: int | None = None
        self.chosen = ""

    @property
    def has_begun(self) -> bool:
        """Whether there is a run to look at."""
        return self._history.run is not None

    @property
    def is_present(self) -> bool:
        """Whether nobody looks back."""
        return self._past is None

    @property
    def robots(self) -> tuple[str, ...]:
        """All robots of the run."""
        return tuple(self._history.run.trees) if self._history.run else ()

    def choose(self, robot: str) -> None:
        """Look at another robot.

        Raises:
            DebugError: there is none of that name.
        """
        if robot not in self.robots:
            raise DebugError(f'there is no robot "{robot}"; {did_you_mean(robot, self.robots, "robots")}')
        self.chosen = robot

    def robot(self, paused_at: str) -> str:
        """The robot that is looked at while the run is paused at one; empty for none."""
        return self.chosen or paused_at or next(iter(self.robots), "")

    def infos(self, robot: str) -> tuple[NodeInfo, ...]:
        """The nodes of a robot's tree, parents before children."""
        if self._history.run is None:
            raise DebugError("the run has not begun yet")
        return self._history.run.trees[robot]

    def tick(self) -> TickSnapshot:
        """The tick that is looked at: an earlier one, or the last that was shown to observers."""
        found = self._history.at(_NEWEST if self._past is None else self._past)
        if found is None:
            raise DebugError("no tick has passed yet; step makes one")
        return found

    def snapshot(self, robot: str) -> RobotSnapshot:
        """A robot at that tick."""
        return next(each for each in self.tick().robots if each.robot == robot)

    def view(self, robot: str) -> View:
        """A robot's tree and blackboard at the end of that tick."""
        found = self.snapshot(robot)
        return View(robot, found.nodes, found.blackboard)

    def trail(self, robot: str) -> list[tuple[float, float]]:
        """Where a robot was up to that tick, (x, y) in metres."""
        return self._history.trail(robot, self.tick().index)

    def travel(self, span: Span, direction: int) -> float:
        """Look so far back (-1) or on (+1); how long ago that is, seconds: 0 is the present."""
        here = self.tick()
        if span.seconds:
            found = self._history.at_time(here.stamp_s + direction * span.seconds)
        else:
            found = self._history.at(here.index + direction * span.ticks)
        newest = self._history.at(_NEWEST)
        assert found is not None  # the tick that is looked at
        assert newest is not None  # is one of them
        self._past = None if found.index >= newest.index else found.index
        return newest.stamp_s - found.stamp_s

    def return_to_present(self) -> None:
        """Look back no more."""
        self._past = None
