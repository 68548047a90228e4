"""Contract of planners: a map and a goal in, a path out."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable

from explore_bt.interfaces.plugin import Plugin, RobotContext
from explore_bt.types import GridWindow, OccupancyGrid, Path, Pose2

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
