"""The ticks of a run, kept in memory to look back at."""

from __future__ import annotations

import operator
import threading
from bisect import bisect_left
from collections import deque
from collections.abc import Sequence
from dataclasses import replace
from typing import ClassVar

from explore_bt.interfaces import (
    API_VERSION,
    Event,
    NodeState,
    PluginOptions,
    RobotSnapshot,
    RunInfo,
    Sink,
    TickSnapshot,
)
from explore_bt.types import Result

__all__ = ["History"]

MOST_TICKS = 18_000
"""Half an hour at 10 Hz."""
MOST_MAP_BYTES = 100_000_000
MOST_EVENTS = 500


class History(Sink):
    """The last ticks and events, as observers were shown them; readable from any thread.

    Bounded: half an hour of ticks, and of these as many as have maps of 100 MB. What has not changed from
    one tick to the next is kept once. (The recording on the disk ends up to a second earlier, and to flush
    it sooner would make a run that was looked at another file than one that was not.)
    """

    name: ClassVar[str] = "history"
    api_version = API_VERSION

    def __init__(self, options: PluginOptions | None = None) -> None:
        super().__init__(options or PluginOptions())
        self._lock = threading.Lock()
        self._ticks: deque[TickSnapshot] = deque()
        self._events: deque[Event] = deque(maxlen=MOST_EVENTS)
        self._map_bytes = 0
        self._run: RunInfo | None = None

    @property
    def run(self) -> RunInfo | None:
        """What was known when the run began; None before."""
        return self._run

    def open(self, run: RunInfo) -> None:
        """The run begins."""
        self._run = run

    def on_tick(self, tick: TickSnapshot) -> None:
        """Keep it, and let go of the oldest."""
        with self._lock:
            last = self._ticks[-1] if self._ticks else None
            kept = replace(
                tick,
                robots=tuple(
                    _lean(robot, last.robots[index] if last else None)
                    for index, robot in enumerate(tick.robots)
                ),
            )
            self._map_bytes += _new_map_bytes(last, kept)
            self._ticks.append(kept)
            while len(self._ticks) > MOST_TICKS or (
                self._map_bytes > MOST_MAP_BYTES and len(self._ticks) > 1
            ):
                oldest = self._ticks.popleft()
                self._map_bytes -= _new_map_bytes(self._ticks[0], oldest)

    def on_event(self, event: Event) -> None:
        """Keep it."""
        with self._lock:
            self._events.append(event)

    def close(self, result: Result | None) -> None:
        """What was kept stays."""

    def at(self, index: int) -> TickSnapshot | None:
        """The tick of that index, else the nearest that is kept; None before the first."""
        with self._lock:
            if not self._ticks:
                return None
            return self._ticks[min(max(index - self._ticks[0].index, 0), len(self._ticks) - 1)]

    def at_time(self, stamp_s: float) -> TickSnapshot | None:
        """The first tick not before that mission time, else the last that is kept; None before the first."""
        with self._lock:
            if not self._ticks:
                return None
            found = bisect_left(self._ticks, stamp_s, key=lambda tick: tick.stamp_s)
            return self._ticks[min(found, len(self._ticks) - 1)]

    def trail(self, robot: str, until: int) -> list[tuple[float, float]]:
        """Where a robot was, (x, y) in metres, at the ticks that are kept up to that index."""
        with self._lock:
            return [
                each.estimate.T_map_base.xy
                for tick in self._ticks
                if tick.index <= until
                for each in tick.robots
                if each.robot == robot
            ]

    def events(self, most: int) -> Sequence[Event]:
        """The newest events, oldest first."""
        with self._lock:
            return list(self._events)[-most:]


def _lean(robot: RobotSnapshot, last: RobotSnapshot | None) -> RobotSnapshot:
    """Without what was measured, and sharing what is as it was."""
    if last is None:
        return replace(robot, measured=(), scan=None)
    nodes: tuple[NodeState, ...] = tuple(
        old if old.status == new.status and old.message == new.message else new
        for old, new in zip(last.nodes, robot.nodes, strict=True)
    )
    board = last.blackboard
    same = len(board) == len(robot.blackboard) and all(
        board.get(key) is value for key, value in robot.blackboard.items()
    )
    return replace(
        robot,
        measured=(),
        scan=None,
        nodes=last.nodes if all(map(operator.is_, nodes, last.nodes)) else nodes,
        blackboard=board if same else robot.blackboard,
    )


def _new_map_bytes(one: TickSnapshot | None, other: TickSnapshot) -> int:
    """How much the maps of ``other`` take that are not those of ``one``, its neighbour."""
    grids = {id(robot.grid) for robot in one.robots} if one else set()
    return sum(robot.grid.cells.nbytes for robot in other.robots if id(robot.grid) not in grids)
