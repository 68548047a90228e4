"""What a report remembers of a whole run."""

from __future__ import annotations

import math
from collections import Counter
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from explore_bt.interfaces import Event, RunInfo, TickSnapshot
from explore_bt.report.history import RobotHistory
from explore_bt.report.overlay import cropped, overlaid
from explore_bt.types import OccupancyGrid

__all__ = ["RunHistory"]

_MOST_EVENTS = 2000
_MOST_SAYINGS = 1000


@dataclass(slots=True)
class RunHistory:
    """All robots' histories and the events, in the mission's order.

    Attributes:
        events: the first 2,000, and 1,000 of what leaves said (level ``debug``); ``events_left_out`` counts
            the others, so that a plugin that floods the log cannot make a report that no browser opens.
    """

    run: RunInfo
    robots: dict[str, RobotHistory] = field(default_factory=dict)
    events: list[Event] = field(default_factory=list)
    events_left_out: int = 0
    end_s: float = 0.0
    _kept: Counter[bool] = field(default_factory=Counter)

    @staticmethod
    def of(run: RunInfo) -> RunHistory:
        """An empty history with one entry a robot."""
        robots = {
            name: RobotHistory(name, run.footprint_radius_m[name], nodes) for name, nodes in run.trees.items()
        }
        return RunHistory(run, robots)

    def on_tick(self, tick: TickSnapshot) -> None:
        """Take in one tick."""
        self.end_s = max(self.end_s, tick.stamp_s)
        for robot in tick.robots:
            self.robots[robot.robot].on_tick(tick.stamp_s, robot)

    def on_event(self, event: Event) -> None:
        """Take in one event."""
        is_saying = event.level == "debug"
        self._kept[is_saying] += 1
        if self._kept[is_saying] <= (_MOST_SAYINGS if is_saying else _MOST_EVENTS):
            self.events.append(event)
        else:
            self.events_left_out += 1

    def map(self) -> OccupancyGrid | None:
        """All robots' last maps in one, cropped; None before the first tick."""
        grids = [robot.grid for robot in self.robots.values() if robot.grid is not None]
        return cropped(overlaid(grids)) if grids else None

    def first_seen_s(self, grid: OccupancyGrid) -> NDArray[np.float32]:
        """(rows, cols) float32 on ``grid``: when any robot first knew a cell, +inf for never."""
        stamps = np.full(grid.shape, math.inf, dtype=np.float32)
        for robot in self.robots.values():
            robot.finish()
            stamps = np.minimum(stamps, robot.first_seen.on(grid))
        return stamps
