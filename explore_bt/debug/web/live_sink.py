"""The sink that keeps a run's messages in memory while it goes on, for its page."""

from __future__ import annotations

from typing import ClassVar

from explore_bt.debug.web.feed import RunFeed
from explore_bt.interfaces import API_VERSION, Event, PluginOptions, RunInfo, Sink, TickSnapshot
from explore_bt.recording import (
    McapRecorderOptions,
    MessageLog,
    RobotTrack,
    followed_topics,
    log_message,
    periods_of,
    result_message,
    run_message,
    stamp_ns,
)
from explore_bt.types import Result

__all__ = ["LiveSink"]

MOST_BYTES = 256_000_000
"""Compressed: some ten hours of a robot with a 2D lidar. Then the oldest is forgotten; the file has it."""


class LiveSink(Sink):
    """Makes the messages that the recorder makes, and lets a page read them.

    Attributes:
        feed: what a ``Desk`` answers from; empty until the run begins.
    """

    name: ClassVar[str] = "page"
    api_version = API_VERSION

    def __init__(self, options: PluginOptions | None = None) -> None:
        super().__init__(options or PluginOptions())
        self.feed = RunFeed(MessageLog(limit_bytes=MOST_BYTES))
        self._tracks: dict[str, RobotTrack] = {}
        self._wanted: frozenset[str] = frozenset()

    def open(self, run: RunInfo) -> None:
        """The run begins."""
        periods = periods_of(McapRecorderOptions.model_validate({}))
        self._wanted = frozenset(topic for robot in run.trees for topic in followed_topics(robot))
        self._tracks = {robot: RobotTrack(robot, self._write, periods, clouds=False) for robot in run.trees}
        self.feed.begin(run_message(run), run.trees)

    def on_tick(self, tick: TickSnapshot) -> None:
        """Add what has changed."""
        time_ns = stamp_ns(tick.stamp_s)
        for robot in tick.robots:
            self._tracks[robot.robot].on_tick(time_ns, tick.index, robot)
        self.feed.end_ns = time_ns

    def on_event(self, event: Event) -> None:
        """Add the event's line."""
        time_ns = stamp_ns(event.stamp_s)
        self.feed.log.add("/events", time_ns, log_message(time_ns, event))

    def close(self, result: Result | None) -> None:
        """Add the last maps and the result."""
        tracks, self._tracks = self._tracks, {}
        for track in tracks.values():
            track.close(self.feed.end_ns)
        if result is not None and tracks:
            self.feed.log.add("/result", self.feed.end_ns, result_message(result))

    def _write(self, topic: str, time_ns: int, text: str) -> None:
        if topic in self._wanted:
            self.feed.log.add(topic, time_ns, text)
