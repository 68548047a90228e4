"""A run as the page gets it: recorded, or still going on."""

from __future__ import annotations

import json
from collections.abc import Collection, Iterator

from explore_bt.recording import (
    LoggedMessage,
    MessageLog,
    Recording,
    Timeline,
    followed_topics,
    state_at,
)

__all__ = ["RunFeed"]

_RUN_TOPICS = ("/events", "/result")


class RunFeed:
    """What is known of a run: its message on ``/run``, all others by time, and its timeline.

    Attributes:
        run_text: the message on ``/run``; empty until the run has begun.
        robots: their names.
        log: every message that the page may want.
        end_ns: mission time up to which the log is whole; later messages belong to a tick that goes on.
        damage: what is missing of a recording, in words; empty for nothing.
    """

    def __init__(self, log: MessageLog, damage: str = "") -> None:
        self.log = log
        self.damage = damage
        self.run_text = ""
        self.robots: tuple[str, ...] = ()
        self.end_ns = log.end_ns
        self.timeline = Timeline(log, ())

    @classmethod
    def of(cls, recording: Recording) -> RunFeed:
        """A recorded run."""
        feed = cls(recording.log(_topics(recording.robots)), recording.damage)
        feed.begin(json.dumps(recording.info, ensure_ascii=False), recording.robots)
        return feed

    def begin(self, run_text: str, robots: Collection[str]) -> None:
        """The run is known from here on."""
        self.robots = tuple(robots)
        self.timeline = Timeline(self.log, self.robots)
        self.run_text = run_text

    def state(self, at_ns: int) -> Iterator[LoggedMessage]:
        """Messages that add up to where every robot was at that time."""
        for robot in self.robots:
            yield from state_at(self.log, robot, at_ns).messages(robot, at_ns)

    def between(self, after_ns: int, until_ns: int) -> Iterator[LoggedMessage]:
        """Messages with ``after_ns < stamp <= until_ns``."""
        return self.log.between(_topics(self.robots), after_ns, until_ns)


def _topics(robots: Collection[str]) -> tuple[str, ...]:
    return (*_RUN_TOPICS, *(topic for robot in robots for topic in followed_topics(robot)))
