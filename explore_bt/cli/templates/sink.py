"""A sink that counts ticks and events and leaves the counts in the run's folder."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Sequence

from explore_bt import hookimpl
from explore_bt.files import write_whole
from explore_bt.interfaces import API_VERSION, Event, RunInfo, Sink, TickSnapshot
from explore_bt.types import Result


class MyPlugin(Sink):
    """Counts ticks and events into my_plugin.json."""

    name = "my_plugin"
    api_version = API_VERSION

    def open(self, run: RunInfo) -> None:
        """The run begins: count from nothing."""
        self._folder = run.folder
        self._counts: Counter[str] = Counter()

    def on_tick(self, tick: TickSnapshot) -> None:
        """One more tick."""
        self._counts["ticks"] = tick.index + 1

    def on_event(self, event: Event) -> None:
        """One more event of its level."""
        self._counts[event.level] += 1

    def close(self, result: Result | None) -> None:
        """Write the counts, and how the run ended."""
        content = {"outcome": result.outcome if result else None, **self._counts}
        write_whole(self._folder / "my_plugin.json", json.dumps(content, indent=2) + "\n")


@hookimpl
def explore_bt_register() -> Sequence[type]:
    """What this distribution brings."""
    return [MyPlugin]
