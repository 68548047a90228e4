"""Answers what the page asks about a run; says nothing about sockets."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable

from explore_bt.debug.web.controls import Controls
from explore_bt.debug.web.feed import RunFeed
from explore_bt.debug.web.requests import AskCommand, AskFollow, AskLook, AskRun, AskState, AskTimeline
from explore_bt.errors import DebugError
from explore_bt.recording import LoggedMessage, to_json

__all__ = ["Desk"]

_ITEMS_AT_ONCE = 4000
_FOLLOW_NS = 20_000_000_000
"""Who is further behind gets a state, not the story: it costs the same however far that is."""


class Desk:
    """Turns requests into JSON; the messages inside go out as they were recorded, text for text.

    Args:
        feed: the run.
        controls: of a run that goes on; without them it can only be looked at.
    """

    def __init__(self, feed: RunFeed, controls: Controls | None = None) -> None:
        self._feed = feed
        self._controls = controls

    async def have_done(self, request: AskLook | AskCommand) -> Callable[[], str]:
        """Have the debugger do something; what is returned makes the members of the answer.

        Raises:
            DebugError: it cannot be done.
        """
        if self._controls is None:
            raise DebugError("this run is a recording: it can only be looked at")
        if isinstance(request, AskLook):
            look = await self._controls.look(request.robot)
            return lambda: f'"messages":{_list(look())}'
        answer = await self._controls.do(request.command)
        return lambda: f'"answer":{json.dumps(to_json(answer), ensure_ascii=False)}'

    def answer(self, request: AskRun | AskState | AskFollow | AskTimeline) -> str:
        """The members of the answer about the run, as JSON text."""
        match request:
            case AskRun():
                return self._run()
            case AskState(at_s=at_s):
                return self._state(_ns(at_s))
            case AskFollow(after_s=after_s, until_s=until_s):
                return self._follow(_ns(after_s), _ns(until_s))
            case AskTimeline(begin=begin):
                return self._timeline(begin)

    def news(self) -> str:
        """How far the run is, as JSON."""
        reach = f'"end_s":{self._feed.end_ns / 1e9},"ready":{json.dumps(bool(self._feed.run_text))}'
        if self._controls is None:
            return f'{{{reach},"live":false}}'
        return f'{{{reach},"live":true,"debug":{self._controls.state()}}}'

    def _run(self) -> str:
        log, damage = self._feed.log, json.dumps(self._feed.damage)
        run = self._feed.run_text or "null"
        reach = f'"begin_s":{log.begin_ns / 1e9},"end_s":{self._feed.end_ns / 1e9}'
        return f'"run":{run},{reach},"damage":{damage}'

    def _state(self, at_ns: int) -> str:
        at_ns = min(max(at_ns, self._feed.log.begin_ns), self._feed.end_ns)
        messages = _list(self._feed.state(at_ns))
        return f'"fresh":true,"at_s":{at_ns / 1e9},"messages":{messages}'

    def _follow(self, after_ns: int, until_ns: int) -> str:
        until_ns = min(until_ns, self._feed.end_ns)
        if until_ns - after_ns > _FOLLOW_NS:
            return self._state(until_ns)
        messages = _list(self._feed.between(after_ns, until_ns))
        return f'"fresh":false,"at_s":{max(after_ns, until_ns) / 1e9},"messages":{messages}'

    def _timeline(self, begin: int) -> str:
        timeline = self._feed.timeline
        timeline.catch_up()
        items = timeline.items[begin : begin + _ITEMS_AT_ONCE]
        end = begin + len(items)
        more = "true" if end < len(timeline.items) else "false"
        return f'"items":[{",".join(items)}],"next":{end},"more":{more}'


def _ns(seconds: float) -> int:
    return round(seconds * 1e9)


def _list(messages: Iterable[LoggedMessage]) -> str:
    each = (f"[{json.dumps(one.topic)},{one.stamp_ns / 1e9},{one.text}]" for one in messages)
    return f"[{','.join(each)}]"
