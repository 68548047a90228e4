"""Contract of planners: a map and a goal in, a path out."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from explore_bt.errors import Cancelled, StartBlocked
from explore_bt.exploration import clearance_field, travel_field
from explore_bt.interfaces.plugin import Plugin, RobotContext
from explore_bt.types import OCCUPIED, GridWindow, OccupancyGrid, Path, Pose2

__all__ = ["Planner", "never"]


def never() -> bool:
    """The ``cancelled`` of a caller who will not cancel."""
    return False


class Planner(Plugin):
    """Finds a way for a circular footprint through known free space."""

    kind = "planner"

    def setup(self, context: RobotContext) -> None:  # most planners need nothing
        """Compile and warm up; called once before the first ``plan``."""

    def expect_change(self, before: OccupancyGrid, now: OccupancyGrid, window: GridWindow) -> None:
        """Told that two states of one map differ within a window only; called before ``plan`` on ``now``.

        Spares a planner that keeps what it derived from ``before`` the look through both; most ignore it.
        """

    @abstractmethod
    def plan(
        self,
        grid: OccupancyGrid,
        start: Pose2,
        goal: Pose2,
        footprint_radius_m: float,
        cancelled: Callable[[], bool] = never,
    ) -> Path:
        """A path from ``start`` to ``goal`` on which no pose has less clearance than the footprint.

        Unknown cells are obstacles. Called from the tree's thread, or from one of its own in wall time:
        keep no state that a second call would trip over, and ask ``cancelled()`` now and then.
        A start that is too close to an obstacle is left by the way that gains clearance; only the
        first poses may then be tighter than the footprint asks.

        Raises:
            StartBlocked, GoalBlocked, GoalUnknown, NoPath, Cancelled: see ``explore_bt.errors``.
        """

    def distances(
        self,
        grid: OccupancyGrid,
        start: Pose2,
        goals: Sequence[Pose2],
        footprint_radius_m: float,
        cancelled: Callable[[], bool] = never,
    ) -> NDArray[np.float64]:
        """Metres to drive from one start to each of many goals, in one pass: to rank goals by.

        About as long as the paths that ``plan`` would find, and called like it. This one is the field of
        shortest ways that exploration ranks by; a planner that keeps a map of its own may be faster.

        Returns:
            (N,) float64; inf where the footprint cannot stand or come.

        Raises:
            StartBlocked, Cancelled: see ``explore_bt.errors``.
        """
        if cancelled():
            raise Cancelled("the distances were cancelled by their caller")
        here = grid.cell_of(start.x, start.y)
        if grid.value_at(start.x, start.y) == OCCUPIED or not grid.contains_cell(*here):
            raise StartBlocked(f"the start ({start.x:.2f}, {start.y:.2f}) lies in no free cell of the map")
        field = travel_field(clearance_field(grid), here, footprint_radius_m, grid.resolution_m)
        cells = [grid.cell_of(goal.x, goal.y) for goal in goals]
        return np.array([field[cell] if grid.contains_cell(*cell) else np.inf for cell in cells], dtype=float)
