"""Asks the planner, and tells it what has changed since it was asked last."""

from __future__ import annotations

from collections.abc import Sequence

from explore_bt.interfaces import Planner, Slam
from explore_bt.runtime.legs import plan_through
from explore_bt.runtime.stop_flag import StopFlag
from explore_bt.types import OccupancyGrid, Path, Pose2

__all__ = ["WayFinder"]


class WayFinder:
    """One robot's planner at work on its SLAM's maps."""

    def __init__(self, planner: Planner, slam: Slam, stop: StopFlag) -> None:
        self._planner = planner
        self._slam = slam
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
        plain = grid if grid is self._slam.grid() else None
        before, self._planned_on = self._planned_on, plain
        if before is None or plain is None or before is plain:
            return
        window = self._slam.changed_since(before.revision)
        if window is not None:
            self._planner.expect_change(before, plain, window)
