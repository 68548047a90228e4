"""Telling the planner where the map has changed since it planned last."""

from __future__ import annotations

from explore_bt.interfaces import Planner, Slam
from explore_bt.types import OccupancyGrid

__all__ = ["MapNews"]


class MapNews:
    """Remembers the map that was planned on last."""

    def __init__(self, slam: Slam, planner: Planner) -> None:
        self._slam = slam
        self._planner = planner
        self._planned_on: OccupancyGrid | None = None

    def tell(self, grid: OccupancyGrid) -> None:
        """Tell where ``grid``, about to be planned on, differs from the one before, if SLAM knows.

        A map with tight places marked has cells that SLAM knows nothing of: then nobody knows.
        """
        plain = grid if grid is self._slam.grid() else None
        before, self._planned_on = self._planned_on, plain
        if before is None or plain is None or before is plain:
            return
        window = self._slam.changed_since(before.revision)
        if window is not None:
            self._planner.expect_change(before, plain, window)
