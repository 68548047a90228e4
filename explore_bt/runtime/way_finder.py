"""Asks the planner, and tells it what has changed since it was asked last."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

from explore_bt.interfaces import Planner
from explore_bt.runtime.legs import plan_through
from explore_bt.runtime.stop_flag import StopFlag
from explore_bt.types import GridWindow, OccupancyGrid, Path, Pose2

__all__ = ["WayFinder"]


class _Maps(Protocol):
    """A map and how it changes: SLAM's, or the team's."""

    def grid(self) -> OccupancyGrid:
        """The newest map."""

    def changed_since(self, revision: int) -> GridWindow | None:
        """Where it may differ from that revision."""


class WayFinder:
    """One robot's planner at work on its maps."""

    def __init__(self, planner: Planner, maps: _Maps, stop: StopFlag) -> None:
        self._planner = planner
        self._maps = maps
        self._stop = stop
        self._planned_on: OccupancyGrid | None = None

    def path(
        self,
        grid: OccupancyGrid,
        here: Pose2,
        goal: Pose2,
        via: Sequence[tuple[float, float]],
        radius_m: float,
    ) -> Path:
        """A path over the places of ``via`` that can be come to.

        Raises:
            PlanningFailure: the planner's typed no.
        """
        self._tell_change(grid)
        return plan_through(
            lambda start, end: self._planner.plan(grid, start, end, radius_m, lambda: self._stop.is_raised),
            here,
            via,
            goal,
        )

    def _tell_change(self, grid: OccupancyGrid) -> None:
        """Tell the planner where the map differs from the one planned on before, if SLAM knows.

        A map with tight places marked has cells that SLAM knows nothing of: then nobody knows.
        """
        plain = grid if grid is self._maps.grid() else None
        before, self._planned_on = self._planned_on, plain
        if before is None or plain is None or before is plain:
            return
        window = self._maps.changed_since(before.revision)
        if window is not None:
            self._planner.expect_change(before, plain, window)
