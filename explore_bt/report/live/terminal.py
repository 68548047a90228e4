"""The sink that shows a run live in a terminal."""

from __future__ import annotations

import atexit
import time
from collections.abc import Callable

from pydantic import Field
from rich.console import Console, Group
from rich.live import Live

from explore_bt.interfaces import API_VERSION, Event, PluginOptions, RunInfo, Sink, TickSnapshot
from explore_bt.report.live.screen import Screen
from explore_bt.types import Result
from explore_bt.units import Duration

__all__ = ["TerminalView", "TerminalViewOptions"]


class TerminalViewOptions(PluginOptions):
    """How often the screen is drawn."""

    period: Duration = Field(
        0.2, ge=0.1, description="wall time between two pictures, however fast the mission's time runs"
    )


class TerminalView(Sink):
    """Coverage, map, active branch and reasons in place; does nothing where there is no terminal.

    The view is throttled by the wall clock, because a simulation may tick a thousand times a second.
    The terminal gets its cursor back on every exit but ``kill -9``.
    """

    name = "terminal"
    api_version = API_VERSION
    Options = TerminalViewOptions

    def __init__(
        self,
        options: PluginOptions,
        console: Console | None = None,
        wall_s: Callable[[], float] = time.monotonic,
    ) -> None:
        super().__init__(options)
        self._period_s = TerminalViewOptions.model_validate(options.model_dump()).period
        self._console = console
        self._wall_s = wall_s
        self._live: Live | None = None
        self._screen: Screen | None = None
        self._tick: TickSnapshot | None = None
        self._begin_s = self._due_s = 0.0

    def open(self, run: RunInfo) -> None:
        """Take over the lower part of the terminal."""
        console = self._console or Console()
        if not console.is_terminal:
            return
        self._screen = Screen(run, console.width - 1, console.height - 1)
        self._begin_s = self._due_s = self._wall_s()
        self._live = Live(console=console, auto_refresh=False, vertical_overflow="crop")
        atexit.register(self._release)
        self._live.start()

    def on_tick(self, tick: TickSnapshot) -> None:
        """Remember the tick; draw if it is time."""
        if self._screen is None:
            return
        self._screen.on_tick(tick)
        self._tick = tick
        if self._wall_s() >= self._due_s:
            self._draw()
            self._due_s = self._wall_s() + self._period_s  # from the end: drawing cannot eat up the run

    def on_event(self, event: Event) -> None:
        """Show warnings and errors in the last line."""
        if self._screen is not None:
            self._screen.on_event(event)

    def close(self, result: Result | None) -> None:  # noqa: ARG002  # the summary is the command line's
        """Leave the last picture standing."""
        if self._live is not None:
            self._draw()
        self._release()

    def _draw(self) -> None:
        if self._live is None or self._screen is None or self._tick is None:
            return
        wall_s = max(self._wall_s() - self._begin_s, 1e-3)
        self._live.update(Group(*self._screen.lines(self._tick, self._tick.stamp_s / wall_s)), refresh=True)

    def _release(self) -> None:
        live, self._live, self._screen = self._live, None, None
        if live is not None:
            atexit.unregister(self._release)
            live.stop()
