"""Sinks, called one by one: the one that fails is cut off, the mission goes on."""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterable, Sequence
from functools import partial

from explore_bt.interfaces import Event, RunInfo, Sink, TickSnapshot
from explore_bt.types import Result

__all__ = ["Observers"]

PATIENCE = 5
"""Failures in a row after which a sink is cut off."""

_log = logging.getLogger("explore_bt")


class Observers:
    """All sinks of a run behind one door."""

    def __init__(self, sinks: Sequence[Sink]) -> None:
        self._failures = dict.fromkeys(sinks, 0)

    def add(self, sinks: Iterable[Sink]) -> None:
        """More of them, before the run begins."""
        self._failures |= dict.fromkeys(sinks, 0)

    def open(self, run: RunInfo) -> None:
        """The run begins; a sink that cannot open is cut off at once."""
        for sink in list(self._failures):
            self._call(sink, partial(sink.open, run), patience=1)

    def tick(self, tick: TickSnapshot) -> None:
        """A tick has ended."""
        for sink in list(self._failures):
            self._call(sink, partial(sink.on_tick, tick))

    def past(self, moments: Iterable[TickSnapshot | Event]) -> None:
        """What was recorded before the run was resumed, for those that want it."""
        if not any(sink.wants_past for sink in self._failures):
            return
        for moment in moments:
            for sink in [each for each in self._failures if each.wants_past]:
                call = sink.on_tick if isinstance(moment, TickSnapshot) else sink.on_event
                self._call(sink, partial(call, moment))  # type: ignore[arg-type]  # the two go together

    def event(self, event: Event) -> None:
        """Something happened."""
        for sink in list(self._failures):
            self._call(sink, partial(sink.on_event, event))

    def close(self, result: Result | None) -> None:
        """The run is over."""
        for sink in list(self._failures):
            self._call(sink, partial(sink.close, result), patience=1)

    def _call(self, sink: Sink, call: Callable[[], None], patience: int = PATIENCE) -> None:
        try:
            call()
        except Exception:
            self._failures[sink] += 1
            if self._failures[sink] >= patience:
                del self._failures[sink]
                _log.exception("sink %s is cut off after %d failures in a row", sink.name, patience)
        else:
            self._failures[sink] = 0
